import fc from "fast-check";
import { expect, it } from "vitest";
import { changedBands, joined } from "./bands";

const size = { rows: 100, columns: 7 };

function changedAt(cells: readonly number[]): Uint8Array {
  const grid = new Uint8Array(size.rows * size.columns);
  for (const index of cells) grid[index] = 1;
  return grid;
}

const places = fc.uniqueArray(fc.nat(size.rows * size.columns - 1), { maxLength: 5 });

it("the changed bands hold all changed cells, few others, and each row once", () => {
  fc.assert(
    fc.property(places, (cells) => {
      const bands = changedBands(size, changedAt([]), changedAt(cells));
      const rows = bands.flatMap(({ begin, end }) =>
        Array.from({ length: end - begin }, (_, i) => begin + i),
      );
      for (const index of cells) expect(rows).toContain(Math.floor(index / size.columns));
      expect(rows.length).toBeLessThanOrEqual(16 * cells.length);
      expect(new Set(rows).size).toBe(rows.length);
    }),
  );
});

it("a grid of another size is new everywhere, the same grid nowhere", () => {
  const grid = changedAt([3]);
  expect(changedBands(size, new Uint8Array(4), grid)).toEqual([{ begin: 0, end: 100 }]);
  expect(changedBands(size, grid, grid)).toEqual([]);
});

it("bands that touch become one", () => {
  const band = (begin: number, end: number) => ({ begin, end });
  expect(joined([band(32, 48), band(0, 16), band(16, 20), band(18, 24)])).toEqual([
    band(0, 24),
    band(32, 48),
  ]);
});
