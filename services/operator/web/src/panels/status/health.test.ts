import { describe, expect, it } from "vitest";
import { Level } from "../../protocol/generated/console_pb";
import { emptyState } from "../../state/console_state";
import { stateOf } from "../../state/fixtures";
import { driveLimits } from "../robots/teleoperation";
import { healthOf, levelClass, levelText, plannerTime, roundTripClass } from "./health";

describe("latency", () => {
  it("of the planner is the slowest robot's newest decision", () => {
    const state = stateOf(
      { case: "search", value: { robot: "r1", durationMs: 12 } },
      { case: "search", value: { robot: "r2", durationMs: 30 } },
    );
    expect(plannerTime(state.searches)).toBeCloseTo(0.03);
    expect(plannerTime(stateOf().searches)).toBeUndefined();
  });

  it("of services counts the healthy ones and names the others", () => {
    const state = stateOf(
      { case: "service", value: { name: "sim_w1", level: Level.OK } },
      { case: "service", value: { name: "planner", level: Level.SILENT } },
      { case: "service", value: { name: "nhpm", level: Level.OK } },
    );
    const { ok, ill } = healthOf(state.services.values());
    expect(ok).toBe(2);
    expect(ill.map(({ name }) => name)).toEqual(["planner"]);
  });

  it("of services is unknown without a link", () => {
    expect(levelText(undefined)).not.toBe(levelText(Level.OK));
    expect(levelClass(undefined)).toBe("quiet");
  });

  it("is amber and red above the limits, or above defaults where there are none", () => {
    const limits = { advisedAgainst: 0.1, refused: 0.2 };
    expect(roundTripClass(0.1, limits)).toBe("good");
    expect(roundTripClass(0.15, limits)).toBe("warn");
    expect(roundTripClass(0.25, limits)).toBe("bad");
    expect(roundTripClass(0.25, driveLimits(emptyState))).toBe("good");
    expect(roundTripClass(undefined, limits)).toBe("quiet");
  });
});
