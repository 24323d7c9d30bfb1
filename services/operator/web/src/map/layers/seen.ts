import type { SeenMap } from "../../protocol/generated/console_pb";
import { type Draw, isolated } from "../draw/context";
import type { Palette } from "../draw/palette";
import { hatchPath } from "../draw/shapes";
import { cellOfIndex, freeCell, type GridSize, isWallAt, unknownCell, wallCell } from "../grid";
import { cellCentre, cellCorner, showsDetail, type View } from "../view";
import { eachVisible } from "./cells";

/** What the robots have seen taken together; of two that disagree the later in `maps` counts. */
export function seenByAny(size: GridSize, maps: Iterable<SeenMap>): Uint8Array {
  const seen = new Uint8Array(size.rows * size.columns);
  for (const { cells } of maps) {
    cells.forEach((value, index) => {
      if (value !== unknownCell && index < seen.length) seen[index] = value;
    });
  }
  return seen;
}

/** A veil, one pixel per cell, over what no robot has seen. */
export function paintFog(context: Draw, size: GridSize, seen: Uint8Array, palette: Palette): void {
  context.fillStyle = palette.fog;
  seen.forEach((value, index) => {
    if (value !== unknownCell) return;
    const { row, column } = cellOfIndex(size, index);
    context.fillRect(column, row, 1, 1);
  });
}

export type SeenData = {
  readonly size: GridSize;
  readonly walls: Uint8Array; // operator's map
  readonly seen: Uint8Array;
};

/** Where robots saw it otherwise than the operator's map: a hatched square = a wall, a ring = free. */
export function drawDifferences(context: Draw, view: View, data: SeenData, palette: Palette): void {
  isolated(context, () => {
    context.strokeStyle = palette.differs;
    context.fillStyle = palette.differs;
    context.lineWidth = Math.max(1.5, Math.min(3, 0.07 * view.scale));
    eachVisible(view, data.size, (cell, index) => {
      const seen = data.seen[index] ?? unknownCell;
      const wall = isWallAt(data.walls, index);
      if (!(seen === wallCell && !wall) && !(seen === freeCell && wall)) return;
      const { x, y } = cellCorner(view, cell);
      if (!showsDetail(view)) context.fillRect(x, y, view.scale, view.scale);
      else if (wall) drawRing(context, view, cellCentre(view, cell));
      else drawSeenWall(context, { x, y }, view.scale);
    });
  });
}

function drawRing(context: Draw, view: View, at: { x: number; y: number }): void {
  context.beginPath();
  context.arc(at.x, at.y, 0.26 * view.scale, 0, 2 * Math.PI);
  context.stroke();
}

function drawSeenWall(context: Draw, corner: { x: number; y: number }, scale: number): void {
  const inset = 0.14 * scale;
  const size = scale - 2 * inset;
  const inner = { x: corner.x + inset, y: corner.y + inset };
  context.beginPath();
  context.rect(inner.x, inner.y, size, size);
  hatchPath(context, inner, size, false);
  context.stroke();
}
