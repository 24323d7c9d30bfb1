import { type Draw, isolated } from "../draw/context";
import type { Palette } from "../draw/palette";
import type { Cell } from "../map_props";
import { cellCorner, type View } from "../view";

/** The keyboard's cell: a frame in two colours, which reads on anything. */
export function drawCursor(context: Draw, view: View, cell: Cell, palette: Palette): void {
  const { x, y } = cellCorner(view, cell);
  const grow = Math.max(1, (10 - view.scale) / 2);
  isolated(context, () => {
    const frame = (width: number, colour: string) => {
      context.lineWidth = width;
      context.strokeStyle = colour;
      const size = view.scale + 2 * grow;
      context.strokeRect(x - grow, y - grow, size, size);
    };
    frame(5, palette.halo);
    frame(2.5, palette.focus);
  });
}

/** The cell under the pointer; or the rectangle that is being drawn from one cell to another. */
export function drawFrame(
  context: Draw,
  view: View,
  data: { from: Cell; to: Cell },
  palette: Palette,
): void {
  const top = Math.min(data.from.row, data.to.row);
  const left = Math.min(data.from.column, data.to.column);
  const rows = Math.abs(data.to.row - data.from.row) + 1;
  const columns = Math.abs(data.to.column - data.from.column) + 1;
  const { x, y } = cellCorner(view, { row: top, column: left });
  isolated(context, () => {
    context.strokeStyle = palette.draft;
    context.lineWidth = 1.5;
    context.strokeRect(x, y, columns * view.scale, rows * view.scale);
  });
}
