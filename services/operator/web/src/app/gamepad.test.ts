import { beforeEach, describe, expect, it } from "vitest";
import { FakeClock } from "../connection/fake";
import { Teleoperation } from "../panels/robots/teleoperation";
import { DriveAction } from "../protocol/generated/console_pb";
import { actionOf, followGamepad, type Pad } from "./gamepad";

const { DRIVE_STOP, DRIVE_FORWARD, DRIVE_BACKWARD, DRIVE_TURN_LEFT, DRIVE_TURN_RIGHT } =
  DriveAction;
const pad = (x: number, y: number, ...pressed: number[]): Pad => ({
  axes: [x, y],
  buttons: Array.from({ length: 17 }, (_, i) => ({ pressed: pressed.includes(i) })),
});

it.each([
  [pad(0, 0), undefined],
  [pad(0.3, -0.4), undefined],
  [pad(0.2, -0.9), DRIVE_FORWARD],
  [pad(0, 1), DRIVE_BACKWARD],
  [pad(-0.9, 0.5), DRIVE_TURN_LEFT],
  [pad(0.9, 0.2), DRIVE_TURN_RIGHT],
  [pad(0, 0, 12), DRIVE_FORWARD],
  [pad(0, 0, 15), DRIVE_TURN_RIGHT],
])("stick and D-pad say how to drive: %#", (given, expected) => {
  expect(actionOf(given)).toBe(expected);
});

describe("a gamepad", () => {
  let now: Pad | null;
  let page: { hidden: boolean; hasFocus: () => boolean };
  let mayDrive: boolean;
  let driven: DriveAction[];
  let driving: Teleoperation;
  let stops: number;
  let clock: FakeClock;

  beforeEach(() => {
    now = pad(0, 0);
    page = { hidden: false, hasFocus: () => true };
    mayDrive = true;
    driven = [];
    stops = 0;
    clock = new FakeClock();
    driving = new Teleoperation({
      clock,
      drive: (_, action) => void driven.push(action),
      chosenRobot: () => "r1",
      blockedReason: () => undefined,
      blocked: () => undefined,
    });
    followGamepad(
      () => [null, now],
      page,
      () => mayDrive,
      driving,
      () => (stops += 1),
      clock,
    );
  });

  it("drives while its stick is held, and stops when it goes back", () => {
    now = pad(0, -1);
    clock.advance(0.06);
    expect(driven).toEqual([DRIVE_FORWARD]);
    clock.advance(0.25);
    expect(driven).toEqual([DRIVE_FORWARD, DRIVE_FORWARD]);
    now = pad(0, 0);
    clock.advance(0.05);
    expect(driven.at(-1)).toBe(DRIVE_STOP);
  });

  it.each([
    ["is unplugged", () => (now = null)],
    ["belongs to a hidden page", () => (page.hidden = true)],
    ["belongs to a page without the focus", () => (page.hasFocus = () => false)],
    ["may no longer drive", () => (mayDrive = false)],
  ])("stops the robot when it %s", (_, happen) => {
    now = pad(0, -1);
    clock.advance(0.06);
    happen();
    clock.advance(0.05);
    expect(driven.at(-1)).toBe(DRIVE_STOP);
  });

  it("drives again only with a new deflection after somebody else ended driving", () => {
    now = pad(0, -1);
    clock.advance(0.06);
    driving.halt();
    const count = driven.length;
    clock.advance(1);
    now = pad(-1, 0);
    clock.advance(0.1);
    expect(driven).toHaveLength(count);
    now = pad(0, 0);
    clock.advance(0.1);
    now = pad(-1, 0);
    clock.advance(0.1);
    expect(driven.at(-1)).toBe(DRIVE_TURN_LEFT);
  });

  it("stops the robot once with its second button", () => {
    now = pad(0, 0, 1);
    clock.advance(0.5);
    expect(stops).toBe(1);
  });
});
