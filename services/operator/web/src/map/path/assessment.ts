import type { SeenMap } from "../../protocol/generated/console_pb";
import { type Cell, cellIndex, cellText, freeCell, isWall, wallCell } from "../grid";
import type { RouteGrid } from "./routes";

/** What is known about a path in advance. */
export type Assessment = {
  readonly steps: number;
  readonly metres: number;
  readonly walls: readonly Cell[]; // see wallsCrossed
  readonly blocked: { readonly cell: Cell; readonly robot: string } | undefined; // seen as a wall
};

export function assess(
  cells: readonly Cell[],
  grid: RouteGrid,
  cellSize: number,
  seen: ReadonlyMap<string, SeenMap>,
): Assessment {
  const steps = Math.max(0, cells.length - 1);
  return {
    steps,
    metres: steps * cellSize,
    walls: wallsCrossed(cells, grid, seen),
    blocked: firstBlocked(cells, grid, seen),
  };
}

/** Walls of the operator's map on the path, except those that a robot saw free. */
export function wallsCrossed(
  cells: readonly Cell[],
  grid: RouteGrid,
  seen: ReadonlyMap<string, SeenMap>,
): readonly Cell[] {
  const maps = [...seen.values()];
  const seenFree = (cell: Cell) => {
    const index = cellIndex(grid.size, cell);
    return maps.some((map) => map.cells[index] === freeCell);
  };
  return cells.filter((cell) => isWall(grid.walls, grid.size, cell) && !seenFree(cell));
}

function firstBlocked(
  cells: readonly Cell[],
  grid: RouteGrid,
  seen: ReadonlyMap<string, SeenMap>,
): Assessment["blocked"] {
  for (const cell of cells) {
    const index = cellIndex(grid.size, cell);
    for (const [robot, map] of seen) {
      if (map.cells[index] === wallCell) return { cell, robot };
    }
  }
  return undefined;
}

/** One or two short sentences. */
export function assessmentText({ steps, metres, walls, blocked }: Assessment): string {
  const length = `${steps} ${steps === 1 ? "step" : "steps"}, ${Number(metres.toFixed(1))} m`;
  if (blocked) {
    return `${length}. Blocked at ${cellText(blocked.cell)}: ${blocked.robot} saw a wall there.`;
  }
  const [first] = walls;
  if (!first) return `${length}.`;
  const crossed = walls.length === 1 ? "a wall" : `${walls.length} wall cells`;
  return `${length}. Crosses ${crossed} of your map at ${cellText(first)}.`;
}
