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

let watch: ControlMonitor;
const both = stateWith({}, held("r1", mine), held("r2", mine));
const look = (now: number, ...bodies: UpdateBody[]) => watch.look(stateWith({}, ...bodies), now);
const givesBack = "“Take control” gives it back.";

beforeEach(() => {
  watch = new ControlMonitor();
  watch.look(both, 50);
});

describe("control that is lost", () => {
  it("to somebody is told with the reason, robots together, and once", () => {
    const taken = [held("r1", "ben", "r1 is stuck"), held("r2", "ben", "r1 is stuck")];
    expect(look(50, ...taken)).toEqual([
      "You control r1, r2 no more: ben took over (“r1 is stuck”).",
    ]);
    expect(look(50, ...taken)).toEqual([]);
  });

  it("because its time ran out is told", () => {
    expect(look(until, held("r1", ""), held("r2", mine))).toEqual([
      `You control r1 no more: the service heard nothing of you for 60 s. ${givesBack}`,
    ]);
  });

  it("because the page was away is told", () => {
    expect(look(until - 30, held("r1", ""))).toEqual([
      `You control r1 no more: the connection was lost for too long. ${givesBack}`,
    ]);
  });

  it("by a new start of the service is told when it speaks of the robot again", () => {
    const anew = (...bodies: UpdateBody[]): ConsoleState => stateWith({ run: "run-2" }, ...bodies);
    expect(watch.look(anew(), 60)).toEqual([]);
    expect(watch.look(anew(held("r1", ""), held("r2", "ben")), 60)).toEqual([
      `You control r1 no more: the service was started anew. ${givesBack}`,
      "You control r2 no more: ben took over.",
    ]);
  });

  it("is told also where a release was refused", () => {
    watch.releases(["r1"]);
    watch.keeps(["r1"]);
    expect(look(until, held("r1", ""))).toHaveLength(1);
  });

  it("is no news when it was released by hand, belonged to somebody else, or in a task", () => {
    watch.releases(["r1"]);
    watch.look(both, 50); // the service has not heard of it
    expect(look(50, held("r1", ""), held("r2", mine))).toEqual([]);
    look(50, held("r1", "ben"), held("r2", mine));
    expect(look(50, held("r1", ""), held("r2", mine))).toEqual([]);
    const task = stateWith({ mode: Mode.MAPPING_TASK }, held("r2", ""));
    expect(watch.look(task, 50)).toEqual([]);
  });
});

const heldBy = (robot: string, holder: string): UpdateBody => ({
  case: "control",
  value: { robot, holder, holderName: holder.toUpperCase() },
});

describe("taking over", () => {
  it("asks for no reason where nobody, or I, have control", () => {
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
