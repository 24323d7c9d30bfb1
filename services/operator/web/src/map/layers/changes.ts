import { type Draw, isolated } from "../draw/context";
import type { Palette } from "../draw/palette";
import { type GridSize, isWallAt } from "../grid";
import { cellCentre, cellCorner, showsDetail, type View } from "../view";
import { eachVisible } from "./cells";

export type ChangesData = {
  readonly size: GridSize;
  readonly walls: Uint8Array;
  readonly initial: Uint8Array;
};

/** What the operator has changed since the first map: plus = wall added, minus = wall taken away. */
export function drawChanges(context: Draw, view: View, data: ChangesData, palette: Palette): void {
  isolated(context, () => {
    context.strokeStyle = palette.changed;
    context.fillStyle = palette.changed;
    context.lineCap = "round";
    eachVisible(view, data.size, (cell, index) => {
      const added = isWallAt(data.walls, index);
      if (added === isWallAt(data.initial, index)) return;
      const corner = cellCorner(view, cell);
      context.globalAlpha = showsDetail(view) ? 0.3 : 0.6;
      context.fillRect(corner.x, corner.y, view.scale, view.scale);
      if (showsDetail(view)) drawSign(context, view, cellCentre(view, cell), added);
    });
  });
}

function drawSign(context: Draw, view: View, at: { x: number; y: number }, plus: boolean): void {
  const reach = Math.min(8, 0.22 * view.scale);
  context.globalAlpha = 1;
  context.lineWidth = Math.max(1.5, Math.min(3, 0.08 * view.scale));
  context.beginPath();
  context.moveTo(at.x - reach, at.y);
  context.lineTo(at.x + reach, at.y);
  if (plus) {
    context.moveTo(at.x, at.y - reach);
    context.lineTo(at.x, at.y + reach);
  }
  context.stroke();
}
