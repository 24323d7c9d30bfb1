import { useRef } from "preact/hooks";
import type { Link } from "../connection/connection";
import { isBetweenMazes, isTask } from "../panels/task/task_state";
import { Mode } from "../protocol/generated/console_pb";
import type { ConsoleState } from "../state/console_state";
import { useConsole } from "./console";

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

/**
 * Why what the page shows may be old; undefined = it is not. The same words as long as the problem is the same, also while the page
 * tries to come back. `shows`: whether the page has been welcomed before, and shows something.
 */
export function linkProblem(link: Link, shows: boolean): string | undefined {
  switch (link.state) {
    case "live":
      return undefined;
    case "stale":
      return "Nothing comes from the operator service: what you see may be old.";
    case "closed":
      return `The operator service closed the connection: ${link.reason}. Reload the page to try again.`;
    case "connecting":
      return shows ? lost : undefined;
    case "lost":
      return shows ? lost : "The operator service cannot be reached.";
  }
}

const lost = "Connection lost: what you see is old. Robots stop when their commands end.";
