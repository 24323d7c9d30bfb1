import { type Draw, isolated } from "../draw/context";
import type { Palette } from "../draw/palette";
import { font, haloStroke, haloText, polyline } from "../draw/shapes";
import type { GridSize } from "../grid";
import type { Cell } from "../map_props";
import { cellCorner, fitView, rulerSize, showsDetail, type View, visibleRange } from "../view";

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

/** CSS pixels from one number of a ruler to the next, at least; numbers of three digits are wider. */
const numberRoom = 24;
const wideNumberRoom = 32;

/** Cells between two numbers, so that they do not overlap: 1, 2, 5, 10, 20, 50, ... */
export function rulerStep(scale: number, room = numberRoom): number {
  const least = room / scale;
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
  isolated(context, () => {
    context.globalAlpha = 0.92;
    context.fillStyle = palette.paper;
    context.fillRect(0, 0, view.width, rulerSize);
    context.fillRect(0, 0, rulerSize, view.height);
    context.globalAlpha = 1;
    context.textAlign = "center";
    context.textBaseline = "middle";
    const write = (number: number, x: number, y: number, here: boolean) => {
      context.font = font(here ? 12 : 11, here ? 700 : 400);
      context.fillStyle = here ? palette.ink : palette.muted;
      context.fillText(`${number}`, x, y);
    };
    const inRuler = (at: number) => at > rulerSize + 4;
    const { row: hereRow, column: hereColumn } = data.cell ?? {};
    const wide = data.size.columns > 100 ? wideNumberRoom : numberRoom;
    for (const column of numbered(range.left, range.right, hereColumn, view.scale, wide)) {
      const x = view.x + (column + 0.5) * view.scale;
      if (inRuler(x)) write(column, x, rulerSize / 2, column === hereColumn);
    }
    for (const row of numbered(range.top, range.bottom, hereRow, view.scale, numberRoom)) {
      const y = view.y + (row + 0.5) * view.scale;
      if (inRuler(y)) write(row, rulerSize / 2, y, row === hereRow);
    }
  });
}

/** Rows or columns whose number fits: `here` always, and no other that would overlap it. */
function numbered(
  first: number,
  last: number,
  here: number | undefined,
  scale: number,
  room: number,
): number[] {
  const step = rulerStep(scale, room);
  const all: number[] = [];
  for (let number = first; number <= last; ++number) {
    const apart = here === undefined ? room : Math.abs(number - here) * scale;
    if (number === here || (number % step === 0 && apart >= room)) all.push(number);
  }
  return all;
}

/** Length of a scale bar of at most `most` CSS pixels: 1, 2 or 5 times a power of ten. */
export function scaleBar(scale: number, cellSize: number, most: number): { m: number; px: number } {
  const longest = (most / scale) * cellSize;
  const power = 10 ** Math.floor(Math.log10(longest));
  const m = power * ([5, 2].find((factor) => factor * power <= longest) ?? 1);
  return { m, px: (m / cellSize) * scale };
}

function lengthText(m: number): string {
  if (m >= 1000) return `${m / 1000} km`;
  return m >= 1 ? `${m} m` : `${Math.round(100 * m)} cm`;
}

/** How long a metre is, in the lower left corner; not on maps that fit with a number for each row, as mazes do. */
export function drawScaleBar(
  context: Draw,
  view: View,
  { rows, columns, cellSize }: GridSize & { readonly cellSize: number },
  palette: Palette,
): void {
  const whole = fitView({ rows, columns }, view.width, view.height);
  if (rulerStep(whole.scale) === 1 || !(cellSize > 0)) return;
  const { m, px } = scaleBar(view.scale, cellSize, 120);
  const left = rulerSize + 10;
  const bottom = view.height - 10;
  isolated(context, () => {
    context.lineCap = "butt";
    haloStroke(context, palette.ink, 2, palette, () =>
      polyline(context, [
        { x: left, y: bottom - 6 },
        { x: left, y: bottom },
        { x: left + px, y: bottom },
        { x: left + px, y: bottom - 6 },
      ]),
    );
    context.font = font(11);
    context.textAlign = "center";
    context.textBaseline = "bottom";
    const middle = { x: left + px / 2, y: bottom - 3 };
    haloText(context, lengthText(m), middle, palette.ink, palette);
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
