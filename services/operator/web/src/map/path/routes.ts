import {
  type Cell,
  cellIndex,
  cellOfIndex,
  contains,
  distance,
  type GridSize,
  isWallAt,
  lineCells,
} from "../grid";

/** The operator's map, as routes need it. */
export type RouteGrid = { readonly size: GridSize; readonly walls: Uint8Array };

const neighbours = [
  { row: -1, column: 0 },
  { row: 0, column: 1 },
  { row: 1, column: 0 },
  { row: 0, column: -1 },
];

/**
 * A shortest 4-connected route over free cells, both ends included, which may be walls; undefined if there is none.
 * Breadth-first search.
 */
export function shortestRoute(grid: RouteGrid, from: Cell, to: Cell): Cell[] | undefined {
  const { size } = grid;
  if (!contains(size, from) || !contains(size, to)) return undefined;
  const target = cellIndex(size, to);
  // Searches from the end, so that following `next` from the start gives the route in order.
  const next = new Int32Array(size.rows * size.columns).fill(-1);
  const goal = cellIndex(size, from);
  const queue = [target];
  next[target] = target;
  for (let read = 0; read < queue.length && next[goal] === -1; ++read) {
    const index = queue[read] ?? 0;
    for (const neighbour of openNeighbours(grid, index, goal)) {
      if (next[neighbour] !== -1) continue;
      next[neighbour] = index;
      queue.push(neighbour);
    }
  }
  return next[goal] === -1 ? undefined : follow(size, next, goal, target);
}

function openNeighbours(grid: RouteGrid, index: number, goal: number): number[] {
  const cell = cellOfIndex(grid.size, index);
  return neighbours
    .map((by) => ({ row: cell.row + by.row, column: cell.column + by.column }))
    .filter((other) => contains(grid.size, other))
    .map((other) => cellIndex(grid.size, other))
    .filter((other) => other === goal || !isWallAt(grid.walls, other));
}

function follow(size: GridSize, next: Int32Array, from: number, to: number): Cell[] {
  const cells = [cellOfIndex(size, from)];
  for (let at = from; at !== to; ) {
    at = next[at] ?? to;
    cells.push(cellOfIndex(size, at));
  }
  return cells;
}

/** The shortest route, or a straight line through walls if there is none. */
export function route(grid: RouteGrid, from: Cell, to: Cell): Cell[] {
  return shortestRoute(grid, from, to) ?? lineCells(from, to);
}

/**
 * Fills the gap between two cells of a line drawn by hand: around a corner of the map, but straight on rather than by a
 * detour. A line through a wall is intended.
 */
export function freehandRoute(grid: RouteGrid, from: Cell, to: Cell): Cell[] {
  const direct = distance(from, to);
  if (direct <= 1) return lineCells(from, to);
  const shortest = shortestRoute(grid, from, to);
  return shortest && shortest.length - 1 <= direct + 2 ? shortest : lineCells(from, to);
}
