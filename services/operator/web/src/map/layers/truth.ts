import { type Draw, isolated } from "../draw/context";
import type { Palette } from "../draw/palette";
import { type GridSize, isWallAt, wallCell } from "../grid";
import { cellCorner, showsDetail, type View } from "../view";
import { eachVisible } from "./cells";

export type TruthData = {
  readonly size: GridSize;
  readonly walls: Uint8Array; // operator's map
  readonly truth: Uint8Array;
};

/** The true walls as frames; a cross where the operator's map is wrong. */
export function drawTruth(context: Draw, view: View, data: TruthData, palette: Palette): void {
  isolated(context, () => {
    context.strokeStyle = palette.truth;
    context.fillStyle = palette.truth;
    context.lineWidth = Math.max(1, Math.min(2.5, 0.06 * view.scale));
    eachVisible(view, data.size, (cell, index) => {
      const wall = data.truth[index] === wallCell;
      const wrong = wall !== isWallAt(data.walls, index);
      const { x, y } = cellCorner(view, cell);
      if (!showsDetail(view)) {
        if (wrong) context.fillRect(x, y, view.scale, view.scale);
        return;
      }
      const inset = 0.1 * view.scale;
      const size = view.scale - 2 * inset;
      if (wall) context.strokeRect(x + inset, y + inset, size, size);
      if (wrong) drawCross(context, x + inset, y + inset, size);
    });
  });
}

function drawCross(context: Draw, x: number, y: number, size: number): void {
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(x + size, y + size);
  context.moveTo(x + size, y);
  context.lineTo(x, y + size);
  context.stroke();
}
