import type { Cell, GridSize } from "./grid";

/** Position and scale of the grid on the canvas, in CSS pixels from its upper left corner. */
export type View = {
  readonly scale: number; // CSS pixels per cell
  readonly x: number; // of the grid's north-western corner
  readonly y: number;
  readonly width: number; // of the canvas
  readonly height: number;
};

export type Point = { readonly x: number; readonly y: number };

/** Size of the rulers at the left and at the top. */
export const rulerSize = 24;

/** Beyond any map: zooming out ends where the whole map is in sight. */
export const smallestScale = 0.02;
export const largestScale = 120;

/** Below this scale cells are too small for grid lines, labels and marks. */
const detailScale = 11;

export function showsDetail(view: View): boolean {
  return view.scale >= detailScale;
}

/** Shows the whole grid as large as possible, centred in the space that the rulers leave. */
export function fitView(size: GridSize, width: number, height: number): View {
  const margin = 8;
  const room = {
    width: Math.max(1, width - rulerSize - 2 * margin),
    height: Math.max(1, height - rulerSize - 2 * margin),
  };
  const scale = limitScale(Math.min(room.width / size.columns, room.height / size.rows));
  return {
    scale,
    x: rulerSize + margin + (room.width - scale * size.columns) / 2,
    y: rulerSize + margin + (room.height - scale * size.rows) / 2,
    width,
    height,
  };
}

function limitScale(scale: number): number {
  return Math.min(largestScale, Math.max(smallestScale, scale));
}

/** Scales by `factor`; the map stays fixed at `point`. */
export function zoomAbout(view: View, point: Point, factor: number): View {
  const scale = limitScale(view.scale * factor);
  const applied = scale / view.scale;
  return {
    ...view,
    scale,
    x: point.x - (point.x - view.x) * applied,
    y: point.y - (point.y - view.y) * applied,
  };
}

export type TwoPoints = readonly [Point, Point];

/** Zooms and pans with two fingers. */
export function pinch(view: View, before: TwoPoints, now: TwoPoints): View {
  const middle = ([a, b]: TwoPoints) => ({ x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 });
  // Limits the zoom when the fingers touch.
  const apart = ([a, b]: TwoPoints) => Math.max(10, Math.hypot(a.x - b.x, a.y - b.y));
  const [from, to] = [middle(before), middle(now)];
  const zoomed = zoomAbout(view, from, apart(now) / apart(before));
  return panBy(zoomed, to.x - from.x, to.y - from.y);
}

export function panBy(view: View, dx: number, dy: number): View {
  return { ...view, x: view.x + dx, y: view.y + dy };
}

/** Keeps at least a few cells visible, so that the map cannot get lost. */
export function keepInSight(view: View, size: GridSize): View {
  const least = Math.min(view.width, view.height, 3 * view.scale + rulerSize);
  const keep = (at: number, length: number, room: number) =>
    Math.min(room - least, Math.max(least - length, at));
  return {
    ...view,
    x: keep(view.x, view.scale * size.columns, view.width),
    y: keep(view.y, view.scale * size.rows, view.height),
  };
}

export function centreOn(view: View, cell: Cell): View {
  return {
    ...view,
    x: rulerSize + (view.width - rulerSize) / 2 - (cell.column + 0.5) * view.scale,
    y: rulerSize + (view.height - rulerSize) / 2 - (cell.row + 0.5) * view.scale,
  };
}

/** Moves as little as needed to show the whole cell. */
export function reveal(view: View, cell: Cell): View {
  const corner = cellCorner(view, cell);
  const shift = (at: number, room: number) =>
    at < rulerSize ? rulerSize - at : Math.min(0, room - view.scale - at);
  return panBy(view, shift(corner.x, view.width), shift(corner.y, view.height));
}

/** The same middle on a canvas of another size. */
export function resized(view: View, width: number, height: number): View {
  return {
    ...view,
    x: view.x + (width - view.width) / 2,
    y: view.y + (height - view.height) / 2,
    width,
    height,
  };
}

/** Upper left corner of the cell. */
export function cellCorner(view: View, cell: Cell): Point {
  return { x: view.x + cell.column * view.scale, y: view.y + cell.row * view.scale };
}

export function cellCentre(view: View, cell: Cell): Point {
  return {
    x: view.x + (cell.column + 0.5) * view.scale,
    y: view.y + (cell.row + 0.5) * view.scale,
  };
}

/** The cell at the point; may lie outside the grid. */
export function cellAt(view: View, point: Point): Cell {
  return {
    row: Math.floor((point.y - view.y) / view.scale),
    column: Math.floor((point.x - view.x) / view.scale),
  };
}

/** Where a grid lies in frame "map": metres, x east, y north, the middle of the grid. */
export type Placement = GridSize & {
  readonly cellSize: number;
  readonly middleX: number;
  readonly middleY: number;
};

/** Point of a position in frame "map". */
export function positionPoint(view: View, world: Placement, at: Point): Point {
  return {
    x: view.x + ((at.x - world.middleX) / world.cellSize + world.columns / 2) * view.scale,
    y: view.y + (world.rows / 2 - (at.y - world.middleY) / world.cellSize) * view.scale,
  };
}

/** Position of a cell's centre in frame "map". */
export function cellPosition(world: Placement, cell: Cell): Point {
  return {
    x: world.middleX + (cell.column - (world.columns - 1) / 2) * world.cellSize,
    y: world.middleY - (cell.row - (world.rows - 1) / 2) * world.cellSize,
  };
}

type CellRange = { top: number; left: number; bottom: number; right: number };

/** The visible cells, both ends included; empty (bottom < top) if there are none. */
export function visibleRange(view: View, size: GridSize): CellRange {
  const first = cellAt(view, { x: 0, y: 0 });
  const last = cellAt(view, { x: view.width, y: view.height });
  return {
    top: Math.max(0, first.row),
    left: Math.max(0, first.column),
    bottom: Math.min(size.rows - 1, last.row),
    right: Math.min(size.columns - 1, last.column),
  };
}
