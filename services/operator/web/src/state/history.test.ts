import { beforeEach, describe, expect, it } from "vitest";
import type { ConsoleState } from "./console_state";
import { stateOf, updates } from "./fixtures";
import { History } from "./history";
import { reduce } from "./reduce";

let history: History;
const at = (x: number) => stateOf({ case: "robot", value: { name: "r1", x } });

beforeEach(() => {
  history = new History();
});

describe("the page's history", () => {
  it("has a moment twice a second, which accepts no commands", () => {
    for (let i = 0; i <= 20; i += 1) history.add(at(i), 100 + i / 10);
    expect(history.length).toBe(5);
    expect(history.span.value).toEqual({ from: 100, to: 102 });
    const moment = history.at(101.2);
    expect(moment?.time).toBe(101);
    expect(moment?.state.robots.get("r1")?.x).toBe(10);
    expect(moment?.state.isPast).toBe(true);
    expect(history.at(50)?.time).toBe(100);
    expect(history.at(500)?.time).toBe(102);
  });

  it("marks the goals that robots reach", () => {
    const goals = (n: number) => Array.from({ length: n }, () => ({ row: 1, column: 1 }));
    const robot = (n: number) =>
      stateOf({ case: "robot", value: { name: "r1", goalsReached: goals(n), goalsTotal: 4 } });
    for (const [i, n] of [1, 1, 2, 2].entries()) history.add(robot(n), 100 + i);
    expect(history.goals.value).toMatchObject([{ position: 102, text: "r1 reached goal 2 of 4" }]);
  });

  it("begins again with the run of a restarted service", () => {
    history.add(at(1), 100);
    history.add({ ...at(2), run: "run-2" }, 100.1);
    expect(history.length).toBe(1);
    expect(history.at(0)?.time).toBe(100.1);
  });

  it("drops older moments where grids that change take too much, and counts those that stay once", () => {
    const seen = (state: ConsoleState) =>
      reduce(
        state,
        updates([{ case: "seen", value: { robot: "r1", cells: new Uint8Array(1000) } }]),
      );
    const same = seen(at(0));
    for (let i = 0; i < 100; i += 1) history.add(same, i, 20_000);
    expect(history.length).toBe(100);
    for (let i = 100; i < 200; i += 1) history.add(seen(at(i)), i, 20_000);
    expect(history.length).toBeLessThan(60);
    expect(history.at(199)?.time).toBe(199);
    expect(history.at(0)?.time).toBe(0);
  });
});
