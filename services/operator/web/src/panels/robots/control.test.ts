import { beforeEach, describe, expect, it } from "vitest";
import { Mode } from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";
import { stateOf, type UpdateBody, welcomeMessage } from "../../state/fixtures";
import { reduce } from "../../state/reduce";
import { ControlMonitor, needsReason, reasonOf, takeOverOf } from "./control";

const until = 100;
const mine = "me/1";
const held = (robot: string, holder: string, reason = ""): UpdateBody => ({
  case: "control",
  value: { robot, holder, holderName: holder === mine ? "" : holder, reason, heldUntil: until },
});

function stateWith(welcome: Parameters<typeof welcomeMessage>[0], ...bodies: UpdateBody[]) {
  const state = reduce(stateOf(), welcomeMessage({ client: mine, ...welcome }));
  return { ...state, controls: stateOf(...bodies).controls };
}

let monitor: ControlMonitor;
const both = stateWith({}, held("r1", mine), held("r2", mine));
const update = (now: number, ...bodies: UpdateBody[]) =>
  monitor.update(stateWith({}, ...bodies), now);
const text = (pattern: RegExp) => expect.stringMatching(pattern);

beforeEach(() => {
  monitor = new ControlMonitor();
  monitor.update(both, 50);
});

describe("control that is lost", () => {
  it("to somebody is reported with the reason, for all robots together, and once", () => {
    const taken = [held("r1", "ben", "r1 is stuck"), held("r2", "ben", "r1 is stuck")];
    expect(update(50, ...taken)).toEqual([text(/r1, r2.*ben.*“r1 is stuck”/)]);
    expect(update(50, ...taken)).toEqual([]);
  });

  it("because its time expired is reported with the time", () => {
    expect(update(until, held("r1", ""), held("r2", mine))).toEqual([text(/ r1: .*60 s/)]);
  });

  it("because the page was away is reported", () => {
    expect(update(until - 30, held("r1", ""))).toEqual([text(/ r1: .*connection/)]);
  });

  it("by a restart of the service is reported once the robot is known again", () => {
    const restarted = (...bodies: UpdateBody[]): ConsoleState =>
      stateWith({ run: "run-2" }, ...bodies);
    expect(monitor.update(restarted(), 60)).toEqual([]);
    expect(monitor.update(restarted(held("r1", ""), held("r2", "ben")), 60)).toEqual([
      text(/ r1: .*restarted/),
      text(/ r2: ben/),
    ]);
  });

  it("is reported also after a refused release", () => {
    monitor.beginRelease(["r1"]);
    monitor.cancelRelease(["r1"]);
    expect(update(until, held("r1", ""))).toHaveLength(1);
  });

  it("is not reported when it was released, belonged to somebody else, or in a task", () => {
    monitor.beginRelease(["r1"]);
    monitor.update(both, 50); // before the service has answered
    expect(update(50, held("r1", ""), held("r2", mine))).toEqual([]);
    update(50, held("r1", "ben"), held("r2", mine));
    expect(update(50, held("r1", ""), held("r2", mine))).toEqual([]);
    const task = stateWith({ mode: Mode.MAPPING_TASK }, held("r2", ""));
    expect(monitor.update(task, 50)).toEqual([]);
  });
});

describe("control that ends soon", () => {
  const soon = (now: number, ...bodies: UpdateBody[]) =>
    monitor.endingSoon(stateWith({}, ...bodies), now);

  it("is warned of once, and again after it was renewed", () => {
    expect(soon(until - 20, held("r1", mine))).toEqual([]);
    expect(soon(until - 14, held("r1", mine), held("r2", "ben"))).toEqual(["r1"]);
    expect(soon(until - 13, held("r1", mine))).toEqual([]);
    const renewed: UpdateBody = {
      case: "control",
      value: { robot: "r1", holder: mine, heldUntil: until + 60 },
    };
    expect(soon(until, renewed)).toEqual([]);
    expect(soon(until + 50, renewed)).toEqual(["r1"]);
  });
});

const heldBy = (robot: string, holder: string): UpdateBody => ({
  case: "control",
  value: { robot, holder, holderName: holder.toUpperCase() },
});

describe("taking over", () => {
  it("needs no reason where nobody, or I, have control", () => {
    const takeOver = takeOverOf(stateOf(heldBy("r1", "me")), ["r1", "r2"]);
    expect(takeOver).toEqual({ robots: ["r1", "r2"], from: [] });
    expect(needsReason(takeOver)).toBe(false);
  });

  it("names each from whom it takes, once", () => {
    const state = stateOf(heldBy("r1", "bo"), heldBy("r2", "bo"), heldBy("r3", "cy"));
    const takeOver = takeOverOf(state, ["r1", "r2", "r3"]);
    expect(takeOver.from).toEqual(["BO", "CY"]);
    expect(needsReason(takeOver)).toBe(true);
  });

  it("takes words as a reason, not blanks", () => {
    expect(reasonOf("  \t ")).toBeUndefined();
    expect(reasonOf(" shift change ")).toBe("shift change");
  });
});
