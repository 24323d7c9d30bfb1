import { useRef } from "preact/hooks";
import type { Link } from "../connection/connection";
import { isBetweenMazes, isTask } from "../panels/task/task_state";
import { Mode } from "../protocol/generated/console_pb";
import type { ConsoleState } from "../state/console_state";
import { useConsole } from "./console";

/** Says that robots were to stop and may not have. */
export function UndeliveredStop() {
  const { store, actions } = useConsole();
  const robots = store.undeliveredStop.value;
  if (robots === undefined) return undefined;
  return (
    <div class="banner undelivered" role="alert">
      STOP NOT DELIVERED: {robots.length === 0 ? "all robots" : robots.join(", ")}
      <button type="button" onClick={() => void actions.stop(robots)}>
        Stop again
      </button>
    </div>
  );
}

/** Says across the page that the data may be old, and why. */
export function LinkBanner() {
  const { store } = useConsole();
  const { state, link } = store;
  const { welcome } = state.value;
  // The service restarts between two steps; that is no problem, unless it stays away.
  if (isCalmBetween(state.value, link.value)) return undefined;
  const problem = linkProblem(link.value, welcome !== undefined, isTask(state.value));
  return (
    <>
      {problem !== undefined && <Problem text={problem} />}
      {problem === undefined && link.value.state === "connecting" && (
        <output class="banner calm">Connecting to the operator service…</output>
      )}
      {/* It has a row of its own, and so stays: nothing moves under a pointer. */}
      {welcome?.mode === Mode.REPLAY && (
        <output class="banner calm fixed">This is a recording. Nothing can be changed.</output>
      )}
    </>
  );
}

/** About a minute. */
const patientAttempts = 20;

/** Whether the step is finished and the page waits for the next one, or for nothing. */
export function isCalmBetween(state: ConsoleState, link: Link): boolean {
  if (!isBetweenMazes(state) || link.state === "closed") return false;
  const isLast = state.task !== undefined && state.task.number >= state.task.count;
  return isLast || link.state !== "lost" || link.attempt <= patientAttempts;
}

function mayBeDemo(state: ConsoleState): boolean {
  return !isTask(state) && state.welcome?.mode !== Mode.REPLAY;
}

/** After this many attempts the service is probably not just restarting. */
const manyAttempts = 4;

function Problem({ text }: { text: string }) {
  const { link, state } = useConsole().store;
  const now = link.value;
  const attempts = useRef(0);
  if (now.state === "lost") attempts.current = now.attempt;
  const attempt = now.state === "lost" ? ` (reconnecting, attempt ${now.attempt})` : "";
  const away = now.state === "lost" || now.state === "connecting";
  return (
    <div class="banner" role="alert">
      {text}
      {/* It changes often, so screen readers skip it. */}
      <span aria-hidden="true">{attempt}</span>
      {away && attempts.current >= manyAttempts && mayBeDemo(state.value) && (
        <p>
          The demo may have ended. <code>./conav demo</code> starts a new one, and this page shows
          it.
        </p>
      )}
    </div>
  );
}

/**
 * Why the data on the page may be old; undefined = it is not. The text stays the same while the page reconnects.
 * `shows`: whether the page has connected before and shows data. `forTask`: it is a participant's.
 */
export function linkProblem(link: Link, shows: boolean, forTask = false): string | undefined {
  const lost = forTask ? lostInTask : lostLink;
  switch (link.state) {
    case "live":
      return undefined;
    case "stale":
      return "No messages from the operator service. The page may be out of date.";
    case "closed":
      return `The operator service closed the connection: ${link.reason}. Reload the page to try again.`;
    case "connecting":
      return shows ? lost : undefined;
    case "lost":
      return shows ? lost : "The operator service cannot be reached.";
  }
}

const lostInTask = "Connection lost. Please wait: nothing is lost, and the page goes on by itself.";
const lostLink =
  "Connection lost. The page is out of date. Robots stop when their commands expire.";
