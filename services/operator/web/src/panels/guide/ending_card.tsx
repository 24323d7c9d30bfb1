import { useSignal } from "@preact/signals";
import { useConsole } from "../../app/console";
import { isWallAt } from "../../protocol/cells";
import { Mode } from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";
import { robotNames } from "../../state/selectors";
import { count } from "../format";
import "./guide.css";

/** Above the map when all goals are reached: a summary of the run, and what to do next. */
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
        <h2 class="good">✓ {goals === 1 ? "Goal" : `All ${goals} goals`} reached</h2>
        <p>
          {count(moves, "move")}, {count(pictures, "picture")} sent, {count(changed, "cell")} of
          your map changed. The run is over. You can still look around.
        </p>
        <p class="quiet">
          Press Ctrl-C in the terminal to quit. <code>./conav replay runs/{run || "<run>"}</code>{" "}
          replays this run. <code>./conav demo --seed 2</code> starts another maze.
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

/** Summary of a run whose robots have reached all goals. */
interface Ending {
  /** Its folder in runs/; empty if it has none. */
  readonly run: string;
  readonly goals: number;
  readonly moves: number;
  readonly pictures: number;
  /** Cells of the operator's maps that differ from the initial maps. */
  readonly changed: number;
}

/** Undefined while robots have goals left, and in recordings. */
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
    pictures: all.reduce((sum, { images }) => sum + Number(images), 0),
    changed: [...beliefs.values()].reduce((sum, belief) => sum + differing(belief), 0),
  };
}

function differing({ walls, initialWalls }: { walls: Uint8Array; initialWalls: Uint8Array }) {
  return walls.filter((_, cell) => isWallAt(walls, cell) !== isWallAt(initialWalls, cell)).length;
}
