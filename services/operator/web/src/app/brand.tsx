import { useComputed } from "@preact/signals";
import { playTime, timeOfDay } from "../panels/format";
import { runTime } from "../state/selectors";
import { useConsole } from "./console";

/** The page's name, the run's clock, by which everything on the page is measured, and the time of day. */
export function Brand() {
  const { store } = useConsole();
  const { state, now } = store;
  const clock = useComputed(() => playTime(runTime(state.value, now.value))).value;
  const day = useComputed(() => (now.value === undefined ? "" : timeOfDay(now.value))).value;
  const run = useComputed(() => state.value.session?.name ?? "").value;
  return (
    <div class="brand" title={run && `Run ${run}`}>
      <h1>
        <svg viewBox="0 0 24 24" width="22" height="22" aria-hidden="true">
          <path d="M3 3h18v18H3zM3 9h6v6h6v6M15 3v6" />
          <circle cx="6" cy="18" r="1.8" />
        </svg>
        conav<span class="unseen"> console</span>
      </h1>
      <time class="run-clock" title="The run's clock">
        {clock}
      </time>
      <time class="quiet" title="Time of day">
        {day}
      </time>
    </div>
  );
}
