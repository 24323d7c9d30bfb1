import { isWallAt } from "../../protocol/cells";
import { Mode } from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";
import { robotNames } from "../../state/selectors";

/** What a run was, when every robot has reached its goals. */
export interface Ending {
  /** Its folder in runs/; empty where it has none. */
  readonly run: string;
  readonly goals: number;
  readonly moves: number;
  readonly pictures: number;
  /** Cells of the operator's maps that are otherwise than at first. */
  readonly changed: number;
}

/** Undefined while robots have goals left, and in recordings, which say themselves where they end. */
export function endingOf(state: ConsoleState): Ending | undefined {
  const { welcome, robots, beliefs } = state;
  if (welcome === undefined || welcome.mode === Mode.REPLAY) return undefined;
  if (robots.size < robotNames(state).length) return undefined;
  const all = [...robots.values()];
  const goals = all.reduce((sum, { goalsTotal }) => sum + goalsTotal, 0);
  if (goals === 0 || all.some(({ goalsLeft }) => goalsLeft.length > 0)) return undefined;
  return {
    run: state.session?.name ?? "",
    goals,
    moves: all.reduce((sum, { cellMoves }) => sum + Number(cellMoves), 0),
    pictures: all.reduce((sum, { pictures }) => sum + Number(pictures), 0),
    changed: [...beliefs.values()].reduce((sum, belief) => sum + differing(belief), 0),
  };
}

function differing({ walls, initialWalls }: { walls: Uint8Array; initialWalls: Uint8Array }) {
  return walls.filter((_, cell) => isWallAt(walls, cell) !== isWallAt(initialWalls, cell)).length;
}
