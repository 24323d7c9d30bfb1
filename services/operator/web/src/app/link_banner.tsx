import { isBetweenMazes } from "../panels/task/task_state";
import { Mode } from "../protocol/generated/console_pb";
import { useConsole } from "./console";
import { linkProblem } from "./link_problem";
import "./link_banner.css";

/** Across the page when what it shows may be old, and why. */
export function LinkBanner() {
  const { store } = useConsole();
  const { state, link } = store;
  const { welcome } = state.value;
  // Between two mazes the service is away, and that is as it should be.
  if (isBetweenMazes(state.value)) return undefined;
  const problem = linkProblem(link.value, welcome !== undefined);
  if (problem !== undefined) return <Problem text={problem} />;
  const text = calmText(link.value.state, welcome?.mode);
  return text === undefined ? undefined : <output class="banner calm">{text}</output>;
}

function Problem({ text }: { text: string }) {
  const { link } = useConsole().store;
  const attempt =
    link.value.state === "lost" ? ` (attempt ${link.value.attempt} to come back)` : "";
  return (
    <div class="banner" role="alert">
      {text}
      {/* It changes all the time: who listens hears of the problem once. */}
      <span aria-hidden="true">{attempt}</span>
    </div>
  );
}

function calmText(link: string, mode: Mode | undefined): string | undefined {
  if (link === "connecting") return "Connecting to the operator service…";
  return mode === Mode.REPLAY ? "This is a recording: nothing can be changed." : undefined;
}
