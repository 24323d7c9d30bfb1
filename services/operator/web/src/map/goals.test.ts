import { describe, expect, it } from "vitest";
import { at, FakePage, robotIn } from "./fixtures";
import { canUndoGoals, clearGoals, undoGoals } from "./goals";
import { MapModel } from "./map_model";
import { ToolDriver } from "./tool_driver";

function bench(offersGoals = true) {
  const robot = robotIn("r1", at(1, 1));
  robot.robot.goalsLeft.push({ ...robot.robot.cell, ...at(3, 3) } as never);
  const page = new FakePage({ tool: "goal", offersGoals, robots: [robot] });
  const model = new MapModel(page.props);
  const press = async (cell = at(1, 3)) => {
    new ToolDriver(model).press(cell, { erase: false });
    await Promise.resolve();
    await Promise.resolve();
  };
  return { page, model, press };
}

describe("goals", () => {
  it("a click sets a goal, a click on a goal removes it", async () => {
    const { page, press } = bench();
    await press();
    await press(at(3, 3));
    expect(page.asked).toEqual([
      { kind: "goals", robot: "r1", add: [at(1, 3)], remove: [] },
      { kind: "goals", robot: "r1", add: [], remove: [at(3, 3)] },
    ]);
  });

  it("undo takes back this page's newest change, once", async () => {
    const { page, model, press } = bench();
    expect(canUndoGoals(model)).toBe(false);
    await press();
    expect(canUndoGoals(model)).toBe(true);
    await undoGoals(model);
    await undoGoals(model);
    expect(page.asked.slice(1)).toEqual([
      { kind: "goals", robot: "r1", add: [], remove: [at(1, 3)] },
    ]);
  });

  it("clear removes all that are left; undo brings them back", async () => {
    const { page, model } = bench();
    await clearGoals(model);
    await undoGoals(model);
    expect(page.asked.map((one) => one.kind === "goals" && one.add.length)).toEqual([0, 1]);
  });

  it("a refused change is not taken back", async () => {
    const { page, model, press } = bench();
    page.outcome = { accepted: false, reason: "outside" };
    await press();
    expect(canUndoGoals(model)).toBe(false);
  });

  it("robots that keep their goals get none", async () => {
    const { page, press } = bench(false);
    await press();
    expect(page.asked).toEqual([]);
  });
});
