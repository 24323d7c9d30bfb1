import { describe, expect, it } from "vitest";
import { AttentionReason, CommandOutcome } from "../../protocol/generated/console_pb";
import { emptyState } from "../../state/console_state";
import { stateOf } from "../../state/fixtures";
import { fleetRow } from "./fleet_row";

describe("a row of the fleet strip", () => {
  it("of a robot that was never heard of is lost", () => {
    expect(fleetRow(emptyState, 10, "r1")).toMatchObject({
      freshness: "lost",
      goalsTotal: 0,
      goalsReached: 0,
      stopped: false,
      stop: undefined,
      wait: undefined,
    });
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
    expect(fleetRow(state, 100, "r1")).toEqual({
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
    expect(fleetRow(stateOf({ case: "control", value }), 0, "r1").stop).toBe(`stopped: ${reason}`);
  });
});
