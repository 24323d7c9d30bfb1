import { type Draw, isolated } from "../draw/context";
import type { Palette } from "../draw/palette";
import { font } from "../draw/shapes";
import type { GridSize } from "../grid";
import type { Cell } from "../map_props";
import { cellCorner, rulerSize, showsDetail, type View, visibleRange } from "../view";

/** Lines between the cells; none when cells are small. */
export function drawGridLines(context: Draw, view: View, size: GridSize, palette: Palette): void {
  if (!showsDetail(view)) return;
  const range = visibleRange(view, size);
  const near = cellCorner(view, { row: range.top, column: range.left });
  const far = cellCorner(view, { row: range.bottom + 1, column: range.right + 1 });
  isolated(context, () => {
    context.strokeStyle = palette.grid;
    context.lineWidth = 1;
    context.beginPath();
    for (let column = range.left; column <= range.right + 1; ++column) {
      const x = Math.round(view.x + column * view.scale) + 0.5;
      context.moveTo(x, near.y);
      context.lineTo(x, far.y);
    }
    for (let row = range.top; row <= range.bottom + 1; ++row) {
      const y = Math.round(view.y + row * view.scale) + 0.5;
      context.moveTo(near.x, y);
      context.lineTo(far.x, y);
    }
    context.stroke();
  });
}

/** Cells between two numbers, so that they do not overlap: 1, 2, 5, 10, 20, 50, ... */
export function rulerStep(scale: number): number {
  const least = 24 / scale;
  let step = 1;
  for (const factor of [2, 2.5, 2, 2, 2.5, 2]) {
    if (step >= least) break;
    step *= factor;
  }
  return step;
}

/** Row numbers at the left edge, column numbers at the top. Those of `cell` are bold. */
export function drawRulers(
  context: Draw,
  view: View,
  data: { size: GridSize; cell: { row: number; column: number } | undefined },
  palette: Palette,
): void {
  const range = visibleRange(view, data.size);
  const step = rulerStep(view.scale);
  isolated(context, () => {
    context.globalAlpha = 0.92;
    context.fillStyle = palette.paper;
    context.fillRect(0, 0, view.width, rulerSize);
    context.fillRect(0, 0, rulerSize, view.height);
    context.globalAlpha = 1;
    context.textAlign = "center";
    context.textBaseline = "middle";
    const write = (number: number, here: boolean, x: number, y: number) => {
      if (number % step !== 0 && !here) return;
      context.font = font(here ? 12 : 11, here ? 700 : 400);
      context.fillStyle = here ? palette.ink : palette.muted;
      if (x >= rulerSize / 2 && y >= rulerSize / 2) context.fillText(`${number}`, x, y);
    };
    const inRuler = (at: number) => at > rulerSize + 4;
    for (let column = range.left; column <= range.right; ++column) {
      const x = view.x + (column + 0.5) * view.scale;
      if (inRuler(x)) write(column, column === data.cell?.column, x, rulerSize / 2);
    }
    for (let row = range.top; row <= range.bottom; ++row) {
      const y = view.y + (row + 0.5) * view.scale;
      if (inRuler(y)) write(row, row === data.cell?.row, rulerSize / 2, y);
    }
  });
}

/** The keyboard cursor: a frame in two colours, visible on any background. */
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

/** Frame around the cell under the pointer, or around the rectangle being drawn. */
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
