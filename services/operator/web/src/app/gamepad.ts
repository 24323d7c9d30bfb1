import type { Clock } from "../connection/clock";
import type { Teleoperation } from "../panels/robots/teleoperation";
import { DriveAction } from "../protocol/generated/console_pb";

/** The parts of a Gamepad that this module uses; the standard mapping. */
export interface Pad {
  readonly axes: readonly number[];
  readonly buttons: readonly { readonly pressed: boolean }[];
}

/** s between two looks at the gamepad: browsers send no events of its sticks. */
const period = 0.05;
/** A stick counts from this deflection on. */
const threshold = 0.5;
const padUp = 12;
const stopButton = 1;

/** What the left stick or the D-pad says: while it is held the robot drives, as with a key. */
export function actionOf({ axes, buttons }: Pad): DriveAction | undefined {
  const is = (button: number) => buttons[button]?.pressed === true;
  const [x = 0, y = 0] = axes;
  const along = Math.abs(y) >= Math.abs(x);
  if (is(padUp) || (along && y <= -threshold)) return DriveAction.DRIVE_FORWARD;
  if (is(padUp + 1) || (along && y >= threshold)) return DriveAction.DRIVE_BACKWARD;
  if (is(padUp + 2) || x <= -threshold) return DriveAction.DRIVE_TURN_LEFT;
  if (is(padUp + 3) || x >= threshold) return DriveAction.DRIVE_TURN_RIGHT;
  return undefined;
}

/**
 * Drives with a gamepad under the rules of the keys: an action begins with a new deflection and ends when the stick goes back, the
 * gamepad is gone, or `page` hides or loses the focus, or nobody may drive. Its second button (B, circle) stops the chosen robot.
 */
export function followGamepad(
  pads: () => readonly (Pad | null)[],
  page: Pick<Document, "hidden" | "hasFocus">,
  mayDrive: () => boolean,
  driving: Teleoperation,
  stop: () => void,
  clock: Clock,
): void {
  let held: DriveAction | undefined;
  /** After driving was stopped from elsewhere the stick first has to go back. */
  let spent = false;
  let stopping = false;
  clock.every(period, () => {
    const pad = pads().find((one) => one !== null) ?? undefined;
    const usable = pad !== undefined && !page.hidden && page.hasFocus();
    const action = usable && mayDrive() ? actionOf(pad) : undefined;
    const stops = usable && pad.buttons[stopButton]?.pressed === true;
    if (stops && !stopping) stop();
    stopping = stops;
    if (held !== undefined && driving.action.peek() === undefined) spent = true;
    if (action === held) return;
    if (held !== undefined) driving.release(held);
    if (action === undefined) spent = false;
    held = action;
    if (action !== undefined && !spent) driving.press(action);
  });
}
