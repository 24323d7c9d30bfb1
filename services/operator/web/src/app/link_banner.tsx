import { useRef } from "preact/hooks";
import { isBetweenMazes, isTask } from "../panels/task/task_state";
import { Mode } from "../protocol/generated/console_pb";
import type { ConsoleState } from "../state/console_state";
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

function mayBeDemo(state: ConsoleState): boolean {
  return !isTask(state) && state.welcome?.mode !== Mode.REPLAY;
}

/** After so many the service is hardly just starting again. */
const manyAttempts = 4;

function Problem({ text }: { text: string }) {
  const { link, state } = useConsole().store;
  const now = link.value;
  const attempts = useRef(0);
  if (now.state === "lost") attempts.current = now.attempt;
  const attempt = now.state === "lost" ? ` (attempt ${now.attempt} to come back)` : "";
  const away = now.state === "lost" || now.state === "connecting";
  return (
    <div class="banner" role="alert">
      {text}
      {/* It changes all the time: who listens hears of the problem once. */}
      <span aria-hidden="true">{attempt}</span>
      {away && attempts.current >= manyAttempts && mayBeDemo(state.value) && (
        <p>
          Perhaps the demo has ended: <code>./conav demo</code> starts another one, which this page
          shows then.
        </p>
      )}
    </div>
  );
}

function calmText(link: string, mode: Mode | undefined): string | undefined {
  if (link === "connecting") return "Connecting to the operator service…";
  return mode === Mode.REPLAY ? "This is a recording: nothing can be changed." : undefined;
}
