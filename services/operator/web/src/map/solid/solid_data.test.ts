import { expect, it } from "vitest";
import { wallsOf } from "./solid_data";

const size = { rows: 1, columns: 6 };
const belief = Uint8Array.of(255, 255, 255, 0, 0, 64);
const seen = Uint8Array.of(0, 2, 1, 2, 1, 0); // unknown, wall, free, wall, free, unknown

it("walls are as high as they are probable, and say what robots saw of them", () => {
  const walls = wallsOf(size, belief, seen);
  expect(walls.map(({ cell, kind }) => [cell.column, kind])).toEqual([
    [0, "belief"],
    [1, "confirmed"],
    [2, "refuted"],
    [3, "missing"],
    [5, "belief"],
  ]);
  expect(walls.map(({ height }) => height)).toEqual([1, 1, 1, 1, 64 / 255]);
});

it("the same maps give the same walls, other ones others", () => {
  expect(wallsOf(size, belief, seen)).toBe(wallsOf(size, belief, seen));
  expect(wallsOf(size, belief, seen.slice())).not.toBe(wallsOf(size, belief, seen));
  expect(wallsOf(size, undefined, seen).map(({ kind }) => kind)).toEqual(["missing", "missing"]);
});
