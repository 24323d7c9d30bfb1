import type { Draw } from "../draw/context";
import type { Palette } from "../draw/palette";
import { cellOfIndex, type GridSize, onBorder } from "../grid";

export type BeliefData = { readonly size: GridSize; readonly walls: Uint8Array };

/** The operator's map, one pixel per cell: the surer a wall, the darker. Border cells have a colour of their own. */
export function paintBelief(context: Draw, { size, walls }: BeliefData, palette: Palette): void {
  context.fillStyle = palette.free;
  context.fillRect(0, 0, size.columns, size.rows);
  for (const border of [true, false]) {
    context.fillStyle = border ? palette.border : palette.wall;
    walls.forEach((value, index) => {
      const cell = cellOfIndex(size, index);
      if (value === 0 || onBorder(size, cell) !== border) return;
      context.globalAlpha = value / 255;
      context.fillRect(cell.column, cell.row, 1, 1);
    });
  }
  context.globalAlpha = 1;
}
