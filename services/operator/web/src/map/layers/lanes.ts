import type { Cell, MapRobot } from "../map_props";
import { cellCentre, type Point, type View } from "../view";

/** Lines of several robots through the same cells lie side by side: how far each is shifted, CSS pixels. */
export function laneShift(robots: readonly MapRobot[], index: number, view: View): number {
  const spacing = Math.min(5, 0.14 * view.scale);
  return (index - (robots.length - 1) / 2) * spacing;
}

export function lanePoints(view: View, cells: readonly Cell[], shift: number): Point[] {
  return cells.map((cell) => {
    const at = cellCentre(view, cell);
    return { x: at.x + shift, y: at.y + shift };
  });
}

/** The robot's mark on the map: large enough to be found on a large map, within its cell on a small one. */
export function markRadius(view: View): number {
  return Math.max(7, Math.min(16, 0.34 * view.scale));
}
