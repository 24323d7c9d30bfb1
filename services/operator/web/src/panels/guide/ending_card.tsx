import { useSignal } from "@preact/signals";
import { useConsole } from "../../app/console";
import { isWallAt } from "../../protocol/cells";
import { Mode } from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";
import { robotNames } from "../../state/selectors";
import { count } from "../format";
import "./guide.css";

/** Over the map when all goals are reached: that it is done, what it took, and what comes next. */
export function EndingCard() {
  const { store } = useConsole();
  const state = store.state.value;
  const dismissed = useSignal("");
  const ending = endingOf(state);
  if (ending === undefined || dismissed.value === state.run) return undefined;
  const { run, goals, moves, pictures, changed } = ending;
  return (
    <section class="stage-card ending" aria-label="End of the run">
      <div>
        <h2 class="good">✓ All {goals} goals reached</h2>
        <p>
          {count(moves, "move")}, {count(pictures, "picture")} sent, {count(changed, "cell")} of
          your map changed. The run is over; look round as long as you like.
        </p>
        <p class="quiet">
          In the terminal Ctrl-C ends it. <code>./conav replay runs/{run || "<run>"}</code> plays it
          again; <code>./conav demo --seed 2</code> is another maze.
        </p>
      </div>
      <button
        type="button"
        class="main"
        onClick={() => {
          dismissed.value = state.run;
        }}
      >
        Done
      </button>
    </section>
  );
}

/** What a run was, when every robot has reached its goals. */
interface Ending {
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
