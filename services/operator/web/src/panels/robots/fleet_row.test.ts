import { describe, expect, it } from "vitest";
import { AttentionReason, CommandOutcome } from "../../protocol/generated/console_pb";
import { emptyState } from "../../state/console_state";
import { stateOf } from "../../state/fixtures";
import { controlText, fleetRow } from "./fleet_row";

describe("a row of the fleet strip", () => {
  it("of a robot that was never heard of says so: it is not lost, nor does it stand", () => {
    expect(fleetRow(emptyState, 10, true, "r1")).toMatchObject({
      freshness: "not heard yet",
      doing: "",
      goalsTotal: 0,
      goalsReached: 0,
      stopped: false,
      stop: undefined,
      wait: undefined,
    });
  });

  it("has no news while the link is down, however young the newest is", () => {
    const state = stateOf({ case: "robot", value: { name: "r1", heardAt: 99.9 } });
    expect(fleetRow(state, 100, true, "r1").freshness).toBe("live");
    expect(fleetRow(state, 100, false, "r1")).toMatchObject({ freshness: "no news" });
    expect(fleetRow(state, 140, false, "r1").age).toBeCloseTo(40.1);
  });

  it("of a robot without goals left is done, whatever its last command", () => {
    const { OUTCOME_DONE } = CommandOutcome;
    const value = { name: "r1", goalsTotal: 4, outcome: OUTCOME_DONE };
    const items = [{ robot: "r1", reason: AttentionReason.REASON_GOALS_REACHED }];
    const state = stateOf({ case: "robot", value }, { case: "attention", value: { items } });
    const row = fleetRow(state, 0, true, "r1");
    expect(row.doing).toContain("all goals");
    expect(row.wait).toBeUndefined();
  });

  it("says that nobody has control only where it can know", () => {
    const row = fleetRow(stateOf(), 0, true, "r1");
    expect(controlText(row, false)).toBe("Nobody has control of r1");
    expect(controlText(row, true)).toContain("not in the recording");
  });

  it("tells goals, age, stop, control and why it waits since when", () => {
    const { OUTCOME_RUNNING } = CommandOutcome;
    const goalsLeft = [{ row: 1, column: 1 }];
    const reason = AttentionReason.REASON_BLOCKED;
    const state = stateOf(
      {
        case: "robot",
        value: { name: "r1", heardAt: 98.5, goalsTotal: 4, goalsLeft, outcome: OUTCOME_RUNNING },
      },
      {
        case: "control",
        value: {
          robot: "r1",
          stopped: true,
          stoppedBy: "carl/1",
          stopReason: "a cat",
          holder: "you",
          holderName: "Bo",
        },
      },
      { case: "attention", value: { stamp: 30, items: [{ robot: "r1", reason, since: 18 }] } },
    );
    expect(fleetRow(state, 100, true, "r1")).toEqual({
      name: "r1",
      freshness: "stale",
      age: 1.5,
      goalsReached: 3,
      goalsTotal: 4,
      stopped: true,
      stop: "stopped by carl: a cat",
      holder: { kind: "other", name: "Bo", reason: "" },
      wait: { why: "is blocked by a wall and waits", seconds: 12 },
      doing: "on its way",
    });
  });

  it("of a robot that nobody has let go yet names nobody", () => {
    const reason = "waits for somebody to let it go";
    const value = { robot: "r1", stopped: true, stopReason: reason };
    expect(fleetRow(stateOf({ case: "control", value }), 0, true, "r1").stop).toBe(
      `stopped: ${reason}`,
    );
  });
});
