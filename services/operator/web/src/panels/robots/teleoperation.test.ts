import { create } from "@bufbuild/protobuf";
import { beforeEach, describe, expect, it } from "vitest";
import { FakeClock } from "../../connection/fake";
import {
  DriveAction,
  LimitsSchema,
  Mode,
  Role,
  WelcomeSchema,
} from "../../protocol/generated/console_pb";
import { stateOf, type UpdateBody, welcomeMessage } from "../../state/fixtures";
import { reduce } from "../../state/reduce";
import { driveBlockedReason, driveLimits, isAdvisedAgainst, Teleoperation } from "./teleoperation";

const { DRIVE_STOP: stop, DRIVE_FORWARD: forward, DRIVE_TURN_LEFT: left } = DriveAction;

let clock: FakeClock;
let sent: [string, DriveAction][];
let robot: string | undefined;
let reason: string | undefined;
let complaints: string[];
let driving: Teleoperation;

beforeEach(() => {
  clock = new FakeClock();
  sent = [];
  robot = "r1";
  reason = undefined;
  complaints = [];
  driving = new Teleoperation({
    clock,
    drive: (name, action) => sent.push([name, action]),
    chosenRobot: () => robot,
    blockedReason: () => reason,
    blocked: (why) => complaints.push(why),
  });
});

const actions = () => sent.map(([, action]) => action);

describe("driving", () => {
  it("begins at once and goes on at 4 Hz while the key is held", () => {
    driving.press(forward);
    expect(actions()).toEqual([forward]);
    clock.advance(1);
    expect(actions()).toEqual([forward, forward, forward, forward, forward]);
  });

  it("is not quicker for a keyboard that repeats", () => {
    driving.press(forward);
    for (let i = 0; i < 10; i += 1) driving.press(forward);
    expect(actions()).toEqual([forward]);
  });

  it("stops once when the key is released, and then is silent", () => {
    driving.press(forward);
    driving.release(forward);
    clock.advance(2);
    expect(actions()).toEqual([forward, stop]);
  });

  it("stops when focus or page are lost, and ignores a later release", () => {
    driving.press(forward);
    driving.halt();
    driving.release(forward);
    clock.advance(2);
    expect(actions()).toEqual([forward, stop]);
  });

  it("uses the newest of two keys, then the other one again", () => {
    driving.press(forward);
    driving.press(left);
    driving.release(left);
    driving.release(forward);
    expect(actions()).toEqual([forward, left, forward, stop]);
  });

  it("stops the robot that was driven when another one is chosen", () => {
    driving.press(forward);
    robot = "r2";
    clock.advance(0.25);
    expect(sent.at(-1)).toEqual(["r1", stop]);
    clock.advance(1);
    expect(sent).toHaveLength(2);
  });

  it("stops when the connection is lost, and does not restart by itself", () => {
    driving.press(forward);
    reason = "lost";
    clock.advance(0.25);
    reason = undefined;
    clock.advance(2);
    expect(actions()).toEqual([forward, stop]);
  });

  it("does not begin where it is forbidden, and reports why", () => {
    reason = "round trip";
    driving.press(forward);
    clock.advance(1);
    expect(sent).toEqual([]);
    expect(complaints).toEqual(["round trip"]);
  });

  it("without a robot does nothing", () => {
    robot = undefined;
    driving.press(forward);
    driving.halt();
    expect(sent).toEqual([]);
  });
});

describe("permission", () => {
  const session: UpdateBody = { case: "session", value: { drives: true } };
  const reported: UpdateBody = { case: "robot", value: { name: "r1", receivedAt: 100 } };
  const live = { state: "live" } as const;
  const quick = { roundTrip: 0.05, clockOffset: 0 };
  const state = stateOf(session, reported);

  it("is given in a method that drives, over a live and quick connection", () => {
    expect(driveBlockedReason(state, live, quick, 100, "r1")).toBeUndefined();
  });

  it("is refused with a reason otherwise", () => {
    const slow = { roundTrip: 1.1, clockOffset: 0 };
    const unknown = { roundTrip: undefined, clockOffset: 0 };
    const stopped = stateOf(session, reported, {
      case: "control",
      value: { robot: "r1", stopped: true },
    });
    const reasons = [
      driveBlockedReason(stateOf(reported), live, quick, 100, "r1"),
      driveBlockedReason(state, { state: "stale", since: 0 }, quick, 100, "r1"),
      driveBlockedReason(state, live, slow, 100, "r1"),
      driveBlockedReason(state, live, unknown, 100, "r1"),
      driveBlockedReason(state, live, quick, 104, "r1"),
      driveBlockedReason(stopped, live, quick, 100, "r1"),
    ];
    expect(reasons).not.toContain(undefined);
    expect(new Set(reasons).size).toBe(reasons.length);
  });

  it("needs a running task and a robot that has reported", () => {
    const inStudy = reduce(state, welcomeMessage({ mode: Mode.STUDY }));
    expect(driveBlockedReason(inStudy, live, quick, 100, "r1")).toBeDefined();
    expect(driveBlockedReason(stateOf(session), live, quick, 100, "r1")).toContain("r1");
  });

  it("uses the limits of the service, or defaults where it sends none", () => {
    const named = { advisedAgainst: 0.2, refused: 0.6 };
    const limits = create(LimitsSchema, { driveAdvisedAgainst: 0.2, driveRefused: 0.6 });
    const welcome = create(WelcomeSchema, { limits, role: Role.OPERATOR });
    expect(driveLimits({ welcome })).toEqual(named);
    expect(driveLimits({ welcome: undefined })).toEqual({ advisedAgainst: 0.3, refused: 1 });
    const at = (roundTrip: number) =>
      driveBlockedReason({ ...state, welcome }, live, { roundTrip, clockOffset: 0 }, 100, "r1");
    expect([at(0.6), at(0.61)]).toEqual([undefined, expect.stringContaining("0.6 s")]);
  });

  it("is given with advice against it between the limits", () => {
    const between = { roundTrip: 0.5, clockOffset: 0 };
    expect(driveBlockedReason(state, live, between, 100, "r1")).toBeUndefined();
    expect(isAdvisedAgainst(state, between)).toBe(true);
    expect(isAdvisedAgainst(state, quick)).toBe(false);
  });
});
