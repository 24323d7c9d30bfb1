import type { SeenMap } from "../../protocol/generated/console_pb";
import { type Cell, cellIndex, cellText, isWall, wallCell } from "../grid";
import type { WayGrid } from "./ways";

/** What is known of a path before anybody drives it. */
export type Assessment = {
  readonly steps: number;
  readonly metres: number;
  readonly walls: readonly Cell[]; // of the operator's own map that it crosses
  readonly blocked: { readonly cell: Cell; readonly robot: string } | undefined; // seen as a wall
};

export function assess(
  cells: readonly Cell[],
  grid: WayGrid,
  cellSize: number,
  seen: ReadonlyMap<string, SeenMap>,
): Assessment {
  const steps = Math.max(0, cells.length - 1);
  return {
    steps,
    metres: steps * cellSize,
    walls: cells.filter((cell) => isWall(grid.walls, grid.size, cell)),
    blocked: firstBlocked(cells, grid, seen),
  };
}

function firstBlocked(
  cells: readonly Cell[],
  grid: WayGrid,
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
