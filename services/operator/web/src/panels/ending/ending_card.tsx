import { useSignal } from "@preact/signals";
import { useConsole } from "../../app/console";
import { count } from "../format";
import { endingOf } from "./ending";
import "./ending.css";

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
