import { describe, expect, it } from "vitest";
import { stateOf, type UpdateBody } from "../../state/fixtures";
import { needsReason, reasonOf, takeOverOf } from "./take_over";

const held = (robot: string, holder: string): UpdateBody => ({
  case: "control",
  value: { robot, holder, holderName: holder.toUpperCase() },
});

describe("taking over", () => {
  it("asks for no reason where nobody, or I, have control", () => {
    const takeOver = takeOverOf(stateOf(held("r1", "me")), ["r1", "r2"]);
    expect(takeOver).toEqual({ robots: ["r1", "r2"], from: [] });
    expect(needsReason(takeOver)).toBe(false);
  });

  it("names each from whom it takes, once", () => {
    const state = stateOf(held("r1", "bo"), held("r2", "bo"), held("r3", "cy"));
    const takeOver = takeOverOf(state, ["r1", "r2", "r3"]);
    expect(takeOver.from).toEqual(["BO", "CY"]);
    expect(needsReason(takeOver)).toBe(true);
  });

  it("takes words as a reason, not blanks", () => {
    expect(reasonOf("  \t ")).toBeUndefined();
    expect(reasonOf(" shift change ")).toBe("shift change");
  });
});
