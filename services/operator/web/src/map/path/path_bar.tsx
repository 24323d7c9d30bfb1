import type { MapModel } from "../map_model";
import type { MapRobot } from "../map_props";
import type { ToolDriver } from "../tool_driver";
import { type Assessment, assessmentText } from "./assessment";
import { hasDraft, isLeft, type PathSession } from "./path_session";

/** For the path tool, and while a path is drafted: facts about the chosen robot's path, and buttons to send or clear it. */
export function PathBar({ model, driver }: { model: MapModel; driver: ToolDriver }) {
  const { robots, chosenRobot, guidance, mayGuide } = model.props.value;
  const robot = robots.find((one) => one.robot.name === chosenRobot);
  const session = model.paths.value.get(chosenRobot ?? "");
  if (!robot || !session) {
    return <p class="map-card">Drag a path from a robot to its destination.</p>;
  }
  const given = guidance.get(robot.robot.name);
  const sent = session.sent !== undefined;
  return (
    <div class={`map-card path ${session.refusal ? "refused" : ""}`}>
      <PathText robot={robot} session={session} model={model} />
      <button
        type="button"
        class="main"
        disabled={!hasDraft(session) || isLeft(session) || sent || !mayGuide.allowed}
        title={mayGuide.allowed ? "Send path (Enter)" : `Not now: ${mayGuide.reason}`}
        onClick={() => driver.send()}
      >
        {session.asked ? "Send anyway" : "Send path"}
      </button>
      <button
        type="button"
        disabled={!hasDraft(session) && !given?.path.length}
        title="Discards the drawing and withdraws the robot's path"
        onClick={() => driver.clear()}
      >
        Clear
      </button>
      <label>
        <input
          type="checkbox"
          checked={model.sendAtRelease.value}
          onChange={(event) => {
            model.sendAtRelease.value = event.currentTarget.checked;
          }}
        />
        Send on release
      </label>
    </div>
  );
}

function PathText(props: { robot: MapRobot; session: PathSession; model: MapModel }) {
  const { robot, session, model } = props;
  const { guidance, nameOf, mayGuide, stopped } = model.props.value;
  const { name } = robot.robot;
  const given = guidance.get(name);
  const cells = hasDraft(session) ? session.cells : (model.ahead.value.get(name) ?? []);
  const known = model.assess(cells);
  return (
    <output class="map-path-facts">
      <strong class="map-robot-name">
        <span class="map-dot" style={{ background: robot.colour }} aria-hidden="true" />
        {name}
      </strong>{" "}
      {stateText(session, cells.length > 1, given?.givenBy && nameOf(given.givenBy))}
      {cells.length > 1 && <KnownText known={known} />}
      {hasDraft(session) && <span class="map-trouble">{doubtText(session)}</span>}
      {stopped && mayGuide.allowed && (
        <span class="map-trouble"> {name} is stopped. Press G to resume.</span>
      )}
      {session.refusal && <span class="map-trouble"> Not sent: {session.refusal}.</span>}
    </output>
  );
}

function KnownText({ known }: { known: Assessment }) {
  const troubled = known.blocked !== undefined || known.walls.length > 0;
  return <span class={troubled ? "map-trouble" : ""}>{assessmentText(known)}</span>;
}

/** Why the draft was not sent at release. */
function doubtText(session: PathSession): string {
  if (isLeft(session)) return ` ${session.robot} has moved away: draw from it again.`;
  if (session.asked) return " Send it anyway?";
  if (session.undrawn > 1 && !session.drawing) return " Dotted: the way to your path.";
  return "";
}

function stateText(session: PathSession, any: boolean, givenBy: string | undefined): string {
  if (session.sent)
    return session.sent.cells.length > 0 ? "Sent, not confirmed yet. " : "Clearing. ";
  if (hasDraft(session)) return session.drawing || session.bend ? "" : "Not sent yet. ";
  if (any) return givenBy ? `Path by ${givenBy}: ` : "Has a path: ";
  return "has no path. Drag from the robot to its destination.";
}
