import type { Link } from "../connection/connection";
import { isBetweenMazes } from "../panels/task/task_state";
import { Mode } from "../protocol/generated/console_pb";
import { useConsole } from "./console";
import "./link_banner.css";

/** Across the page when what it shows may be old, and why. */
export function LinkBanner() {
  const { store } = useConsole();
  // Between two mazes the service is away, and that is as it should be.
  if (isBetweenMazes(store.state.value)) return undefined;
  const problem = linkText(store.link.value);
  const text = problem ?? modeText(store.state.value.welcome?.mode);
  return text === undefined ? undefined : (
    <output class={`banner ${problem === undefined ? "calm" : ""}`}>{text}</output>
  );
}

function linkText(link: Link): string | undefined {
  switch (link.state) {
    case "connecting":
      return "Connecting to the operator service…";
    case "stale":
      return "Nothing comes from the operator service: what you see may be old.";
    case "lost":
      return `Connection lost (attempt ${link.attempt} to come back): what you see is old. Robots stop when their commands end.`;
    case "closed":
      return `The operator service closed the connection: ${link.reason}. Reload the page to try again.`;
    default:
      return undefined;
  }
}

function modeText(mode: Mode | undefined): string | undefined {
  return mode === Mode.REPLAY ? "This is a recording: nothing can be changed." : undefined;
}
