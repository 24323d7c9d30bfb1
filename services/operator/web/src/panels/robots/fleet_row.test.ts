import { describe, expect, it } from "vitest";
import { AttentionReason, CommandOutcome } from "../../protocol/generated/console_pb";
import { emptyState } from "../../state/console_state";
import { stateOf } from "../../state/fixtures";
import { reasonText } from "../attention/queue_texts";
import { controlText, fleetRow } from "./fleet_row";

describe("a row of the fleet strip", () => {
  it("of a robot without any state is neither lost nor idle", () => {
    expect(fleetRow(emptyState, 10, true, "r1")).toMatchObject({
      freshness: "no data yet",
      doing: "",
      goalsTotal: 0,
      goalsReached: 0,
      stopped: false,
      stop: undefined,
      wait: undefined,
    });
  });

  it("is unknown while the link is down, however new its state is", () => {
    const state = stateOf({ case: "robot", value: { name: "r1", receivedAt: 99.9 } });
    expect(fleetRow(state, 100, true, "r1").freshness).toBe("live");
    expect(fleetRow(state, 100, false, "r1")).toMatchObject({ freshness: "unknown" });
    expect(fleetRow(state, 140, false, "r1").age).toBeCloseTo(40.1);
  });

  it("of a robot without goals left is done, whatever its last command", () => {
    const { OUTCOME_DONE } = CommandOutcome;
    const value = { name: "r1", goalsTotal: 4, outcome: OUTCOME_DONE };
    const items = [{ robot: "r1", reason: AttentionReason.REASON_GOALS_REACHED }];
    const state = stateOf({ case: "robot", value }, { case: "attention", value: { items } });
    const row = fleetRow(state, 0, true, "r1");
    expect(row.doing).toMatch(/^✓/);
    expect(row.wait).toBeUndefined();
  });

  it("says that nobody has control only where this is known", () => {
    const row = fleetRow(stateOf(), 0, true, "r1");
    expect(controlText(row, false)).toMatch(/nobody.* r1/i);
    expect(controlText(row, true)).not.toMatch(/nobody/i);
  });

  it("has goals, age, stop, control, and why and how long it waits", () => {
    const { OUTCOME_RUNNING } = CommandOutcome;
    const goalsLeft = [{ row: 1, column: 1 }];
    const reason = AttentionReason.REASON_BLOCKED;
    const state = stateOf(
      {
        case: "robot",
        value: { name: "r1", receivedAt: 98.5, goalsTotal: 4, goalsLeft, outcome: OUTCOME_RUNNING },
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
      stop: expect.stringMatching(/carl.*a cat/),
      holder: { kind: "other", name: "Bo", reason: "" },
      wait: { why: reasonText(reason, false), seconds: 12 },
      doing: "■ stopping…",
    });
  });

  it("says stopped by its own report where nobody here has stopped the robot", () => {
    const value = { name: "r1", stopped: true };
    const row = fleetRow(stateOf({ case: "robot", value }), 0, true, "r1");
    expect(row).toMatchObject({ stopped: true, doing: "■ stopped" });
    expect(row.stop).toContain("own report");
  });

  it("of a robot that was stopped from the start names nobody", () => {
    const reason = "not started";
    const value = { robot: "r1", stopped: true, stopReason: reason };
    const { stop } = fleetRow(stateOf({ case: "control", value }), 0, true, "r1");
    expect(stop).toContain(reason);
    expect(stop).not.toContain(" by ");
  });
});
