import fc from "fast-check";
import { expect, it } from "vitest";
import { cellIndex, cellOfIndex, distance, lineCells, onBorder, rectangleCells } from "./grid";

const at = (row: number, column: number) => ({ row, column });
const cells = fc.record({ row: fc.integer({ min: -50, max: 50 }), column: fc.nat(50) });

it("a line has both ends, goes by neighbours and no further than needed", () => {
  fc.assert(
    fc.property(cells, cells, (from, to) => {
      const line = lineCells(from, to);
      expect(line[0]).toEqual(from);
      expect(line.at(-1)).toEqual(to);
      expect(line).toHaveLength(distance(from, to) + 1);
      expect(line.every((cell, i) => i === 0 || distance(cell, line[i - 1] ?? cell) === 1)).toBe(
        true,
      );
    }),
  );
});

it("a line stays close to the straight one", () => {
  const line = lineCells(at(0, 0), at(10, 20));
  expect(line.every(({ row, column }) => Math.abs(column - 2 * row) <= 2)).toBe(true);
});

it("a rectangle has all cells between its corners, whichever they are", () => {
  const expected = [at(1, 2), at(1, 3), at(2, 2), at(2, 3)];
  expect(rectangleCells(at(1, 2), at(2, 3))).toEqual(expected);
  expect(rectangleCells(at(2, 3), at(1, 2))).toEqual(expected);
  expect(rectangleCells(at(4, 4), at(4, 4))).toEqual([at(4, 4)]);
});

it("indices are row-major, and the border is all around", () => {
  const size = { rows: 3, columns: 4 };
  expect(cellIndex(size, at(1, 2))).toBe(6);
  expect(cellOfIndex(size, 6)).toEqual(at(1, 2));
  const inner = rectangleCells(at(0, 0), at(2, 3)).filter((cell) => !onBorder(size, cell));
  expect(inner).toEqual([at(1, 1), at(1, 2)]);
});
