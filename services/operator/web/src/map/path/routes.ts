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

/** A map for routes: walls of the operator's map, except where robots saw something else. */
export type RouteGrid = { readonly size: GridSize; readonly walls: Uint8Array };

/**
 * A shortest 4-connected route over free cells, both ends included, which may be walls; undefined if there is none of at most
 * `most` steps. Breadth-first search.
 */
export function shortestRoute(
  grid: RouteGrid,
  from: Cell,
  to: Cell,
  most = Number.POSITIVE_INFINITY,
): Cell[] | undefined {
  const { size } = grid;
  if (!contains(size, from) || !contains(size, to)) return undefined;
  const target = cellIndex(size, to);
  // Searches from the end, so that following `next` from the start gives the route in order.
  const next = new Int32Array(size.rows * size.columns).fill(-1);
  const goal = cellIndex(size, from);
  let reached = [target];
  next[target] = target;
  for (let steps = 0; steps < most && reached.length > 0 && next[goal] === -1; ++steps) {
    reached = stepped(grid, reached, next, goal);
  }
  return next[goal] === -1 ? undefined : follow(size, next, goal, target);
}

/** The cells one step beyond `reached`. Maps have a million cells, so this makes no object for each. */
function stepped(grid: RouteGrid, reached: number[], next: Int32Array, goal: number): number[] {
  const { rows, columns } = grid.size;
  const beyond: number[] = [];
  const enter = (neighbour: number, index: number) => {
    if (next[neighbour] !== -1 || (neighbour !== goal && isWallAt(grid.walls, neighbour))) return;
    next[neighbour] = index;
    beyond.push(neighbour);
  };
  for (const index of reached) {
    const column = index % columns;
    if (index >= columns) enter(index - columns, index);
    if (column < columns - 1) enter(index + 1, index);
    if (index < (rows - 1) * columns) enter(index + columns, index);
    if (column > 0) enter(index - 1, index);
  }
  return beyond;
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
  return shortestRoute(grid, from, to, direct + 2) ?? lineCells(from, to);
}
