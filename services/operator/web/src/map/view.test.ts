import fc from "fast-check";
import { describe, expect, it } from "vitest";
import {
  cellAt,
  cellCentre,
  cellPosition,
  centreOn,
  fitView,
  keepInSight,
  largestScale,
  panBy,
  pinch,
  positionPoint,
  resized,
  reveal,
  rulerSize,
  smallestScale,
  type TwoPoints,
  visibleRange,
  zoomAbout,
} from "./view";

const size = { rows: 13, columns: 21 };
const start = () => fitView(size, 800, 600);

const views = fc
  .record({
    scale: fc.double({ min: smallestScale, max: largestScale, noNaN: true }),
    x: fc.double({ min: -2000, max: 2000, noNaN: true }),
    y: fc.double({ min: -2000, max: 2000, noNaN: true }),
  })
  .map((at) => ({ ...at, width: 800, height: 600 }));

it("a cell's centre lies in the cell, in every view", () => {
  fc.assert(
    fc.property(views, fc.nat(12), fc.nat(20), (view, row, column) => {
      expect(cellAt(view, cellCentre(view, { row, column }))).toEqual({ row, column });
    }),
  );
});

it("the cell under the pointer is right over a large map, from all of it to one cell", () => {
  const large = { rows: 1000, columns: 1000 };
  const whole = fitView(large, 800, 600);
  const cell = fc.nat(999);
  fc.assert(
    fc.property(cell, cell, fc.double({ min: 1, max: 200, noNaN: true }), (row, column, factor) => {
      const view = reveal(zoomAbout(whole, cellCentre(whole, { row, column }), factor), {
        row,
        column,
      });
      expect(cellAt(view, cellCentre(view, { row, column }))).toEqual({ row, column });
      const { top, left, bottom, right } = visibleRange(view, large);
      expect(row >= top && row <= bottom && column >= left && column <= right).toBe(true);
    }),
  );
});

it("zooming keeps what lies at the point, also at the limits", () => {
  const point = fc.record({ x: fc.nat(800), y: fc.nat(600) });
  const factor = fc.double({ min: 0.01, max: 100, noNaN: true });
  fc.assert(
    fc.property(views, point, factor, (view, at, by) => {
      const zoomed = zoomAbout(view, at, by);
      expect(zoomed.scale).toBeGreaterThanOrEqual(smallestScale);
      expect(zoomed.scale).toBeLessThanOrEqual(largestScale);
      expect((at.x - zoomed.x) / zoomed.scale).toBeCloseTo((at.x - view.x) / view.scale, 6);
      expect((at.y - zoomed.y) / zoomed.scale).toBeCloseTo((at.y - view.y) / view.scale, 6);
    }),
  );
});

it("fitting shows all cells, clear of the rulers, at any size", () => {
  const squares = [3, 150, 1000, 4096].map((side) => ({ rows: side, columns: side }));
  for (const grid of [size, ...squares]) {
    const view = fitView(grid, 800, 600);
    expect(view.x).toBeGreaterThan(rulerSize);
    expect(view.y).toBeGreaterThan(rulerSize);
    expect(view.x + grid.columns * view.scale).toBeLessThanOrEqual(800);
    expect(view.y + grid.rows * view.scale).toBeLessThanOrEqual(600);
    expect(visibleRange(view, grid)).toMatchObject({ top: 0, left: 0, bottom: grid.rows - 1 });
  }
});

describe("two fingers", () => {
  const before: TwoPoints = [
    { x: 100, y: 100 },
    { x: 200, y: 100 },
  ];
  const moved = (dx: number, dy: number, apart: number): TwoPoints => [
    { x: 150 + dx - apart / 2, y: 100 + dy },
    { x: 150 + dx + apart / 2, y: 100 + dy },
  ];
  const view = { scale: 20, x: 30, y: 40, width: 400, height: 300 };

  it("move the map with them", () => {
    expect(pinch(view, before, moved(7, -5, 100))).toEqual({ ...view, x: 37, y: 35 });
  });

  it("zoom about their middle", () => {
    const near = pinch(view, before, moved(0, 0, 200));
    expect(near.scale).toBe(40);
    expect((150 - near.x) / near.scale).toBeCloseTo((150 - view.x) / view.scale);
  });

  it("that meet in a point zoom no further", () => {
    expect(pinch(view, moved(0, 0, 0), moved(0, 0, 5)).scale).toBe(20);
  });
});

describe("moving", () => {
  it("keeps some of the grid in sight", () => {
    for (const [dx, dy] of [
      [9999, 0],
      [-9999, 0],
      [0, 9999],
      [0, -9999],
    ] as const) {
      const { top, bottom, left, right } = visibleRange(
        keepInSight(panBy(start(), dx, dy), size),
        size,
      );
      expect(bottom).toBeGreaterThanOrEqual(top);
      expect(right).toBeGreaterThanOrEqual(left);
    }
  });

  it("centres a cell", () => {
    const at = cellCentre(centreOn(start(), { row: 2, column: 3 }), { row: 2, column: 3 });
    expect(at.x).toBeCloseTo((800 + rulerSize) / 2);
    expect(at.y).toBeCloseTo((600 + rulerSize) / 2);
  });

  it("reveals a hidden cell, and leaves the view of a visible one alone", () => {
    const close = zoomAbout(start(), { x: 400, y: 300 }, 8);
    const corner = { row: 0, column: 0 };
    expect(visibleRange(close, size)).not.toMatchObject({ top: 0, left: 0 });
    const shown = reveal(close, corner);
    expect(visibleRange(shown, size)).toMatchObject({ top: 0, left: 0 });
    expect(reveal(shown, corner)).toEqual(shown);
  });

  it("keeps the middle when the canvas changes its size", () => {
    const before = start();
    const middle = cellAt(before, { x: 400, y: 300 });
    expect(cellAt(resized(before, 1000, 400), { x: 500, y: 200 })).toEqual(middle);
  });
});

it("positions in metres: the origin is the grid's middle, north is up", () => {
  const view = { scale: 10, x: 0, y: 0, width: 800, height: 600 };
  const grid = { rows: 4, columns: 6, cellSize: 2, middleX: 0, middleY: 0 };
  expect(positionPoint(view, grid, { x: 0, y: 0 })).toEqual({ x: 30, y: 20 });
  expect(positionPoint(view, grid, { x: 2, y: 2 })).toEqual({ x: 40, y: 10 });
});

it("positions of a map with another origin: a cell's centre is shown in the cell", () => {
  const view = { scale: 10, x: 3, y: 4, width: 800, height: 600 };
  const grid = { rows: 4, columns: 6, cellSize: 0.5, middleX: 12, middleY: -7 };
  expect(cellPosition(grid, { row: 0, column: 0 })).toEqual({ x: 10.75, y: -6.25 });
  for (const cell of [
    { row: 0, column: 0 },
    { row: 3, column: 5 },
  ]) {
    expect(positionPoint(view, grid, cellPosition(grid, cell))).toEqual(cellCentre(view, cell));
  }
});
