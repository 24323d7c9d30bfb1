import { describe, expect, it } from "vitest";
import { Mode } from "../../protocol/generated/console_pb";
import { stateOf, type UpdateBody, welcomeMessage } from "../../state/fixtures";
import { reduce } from "../../state/reduce";
import { endingOf } from "./ending_card";

const robot = (name: string, left: number): UpdateBody => ({
  case: "robot",
  value: {
    name,
    goalsTotal: 4,
    goalsLeft: Array.from({ length: left }, (_, column) => ({ row: 0, column })),
    cellMoves: 20n,
    images: 3n,
  },
});
const belief: UpdateBody = {
  case: "belief",
  value: {
    world: "w1",
    walls: new Uint8Array([0, 255, 200]),
    initialWalls: new Uint8Array([255, 255, 0]),
  },
};

describe("the end of a run", () => {
  it("is when no robot has a goal left, and sums up the run", () => {
    expect(endingOf(stateOf(robot("r1", 0), robot("r2", 1), belief))).toBeUndefined();
    const session: UpdateBody = { case: "session", value: { name: "20261122-seed1" } };
    expect(endingOf(stateOf(session, robot("r1", 0), robot("r2", 0), belief))).toEqual({
      run: "20261122-seed1",
      goals: 8,
      moves: 40,
      pictures: 6,
      changed: 2,
    });
  });

  it("is none before robots and goals are known, nor in a recording", () => {
    expect(endingOf(stateOf())).toBeUndefined();
    expect(endingOf(stateOf({ case: "robot", value: { name: "r1" } }))).toBeUndefined();
    const done = stateOf(robot("r1", 0));
    expect(endingOf(reduce(done, welcomeMessage({ mode: Mode.REPLAY })))).toBeUndefined();
  });
});
