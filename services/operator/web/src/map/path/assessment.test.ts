import { create } from "@bufbuild/protobuf";
import { expect, it } from "vitest";
import { SeenMapSchema } from "../../protocol/generated/console_pb";
import { assess, assessmentText } from "./assessment";

const grid = { size: { rows: 1, columns: 4 }, walls: Uint8Array.of(0, 0, 255, 0) };
const path = [0, 1, 2, 3].map((column) => ({ row: 0, column }));

function seenBy(robot: string, ...cells: number[]) {
  return new Map([[robot, create(SeenMapSchema, { robot, cells: Uint8Array.from(cells) })]]);
}

it("has the length, and the walls of the operator's own map", () => {
  const crossing = assess(path, grid, 2, new Map());
  expect(crossing).toMatchObject({ steps: 3, metres: 6, blocked: undefined });
  expect(assessmentText(crossing)).toMatch(/^3 steps, 6 m\. .* row 0, column 2\.$/);
  expect(assessmentText(assess(path.slice(0, 2), grid, 2, new Map()))).toMatch(/^1 step, 2 m\.$/);
});

it("names the first wall that a robot has seen", () => {
  const blocked = assess(path, grid, 2, seenBy("r2", 1, 2, 0, 0));
  expect(blocked.blocked).toEqual({ cell: { row: 0, column: 1 }, robot: "r2" });
  expect(assessmentText(blocked)).toMatch(/row 0, column 1: r2 /);
  expect(assess(path, grid, 2, seenBy("r2", 1, 1, 0, 1)).blocked).toBeUndefined();
});

it("treats cells that a robot saw free as free, whatever the map says", () => {
  expect(assess(path, grid, 2, seenBy("r2", 0, 0, 1, 0)).walls).toEqual([]);
  expect(assess(path, grid, 2, seenBy("r2", 0, 0, 0, 0)).walls).toHaveLength(1);
});
