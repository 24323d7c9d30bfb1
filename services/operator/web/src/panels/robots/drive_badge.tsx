import { useConsole } from "../../app/console";
import { editsMap } from "../../map/map_props";
import { DriveAction } from "../../protocol/generated/console_pb";
import { milliseconds } from "../format";
import { driveBlockedReason, isAdvisedAgainst } from "./teleoperation";
import { TouchStick } from "./touch_stick";
import "./robots.css";

const actionTexts: Readonly<Record<DriveAction, string>> = {
  [DriveAction.DRIVE_STOP]: "standing still",
  [DriveAction.DRIVE_FORWARD]: "↑ forward",
  [DriveAction.DRIVE_BACKWARD]: "↓ backward",
  [DriveAction.DRIVE_TURN_LEFT]: "← left",
  [DriveAction.DRIVE_TURN_RIGHT]: "→ right",
};

/** In methods driven by hand: what the keys do now, or why they do nothing. */
export function DriveBadge() {
  const { store, teleoperation } = useConsole();
  const { state, link, timing, now } = store;
  const robot = store.chosenRobot.value;
  if (!state.value.session?.drives || robot === undefined) return undefined;
  const blocked = driveBlockedReason(state.value, link.value, timing.value, now.value, robot);
  const action = teleoperation.action.value;
  return (
    <div class="drive panel">
      <output>
        {blocked !== undefined ? (
          <span class="bad">You cannot drive: {blocked}.</span>
        ) : editsMap(store.tool.value) ? (
          <span>
            You are editing the map. Press <kbd>Esc</kbd> to drive <strong>{robot}</strong> again.
          </span>
        ) : (
          <span>
            Hold the arrow keys to drive <strong>{robot}</strong>:{" "}
            <strong class={action === undefined ? "quiet" : "good"}>
              {actionTexts[action ?? DriveAction.DRIVE_STOP]}
            </strong>
          </span>
        )}
      </output>
      <TouchStick />
      {/* Not in the live region: it changes with each ping. */}
      {blocked === undefined && isAdvisedAgainst(state.value, timing.value) && (
        <span class="warn">
          The round trip is {milliseconds(timing.value.roundTrip)}: drive with care.
        </span>
      )}
    </div>
  );
}
