import { type Draw, isolated } from "../draw/context";
import type { Palette } from "../draw/palette";
import { hatchPath } from "../draw/shapes";
import type { Draft } from "../edit/edit_session";
import { cellOfIndex, type GridSize } from "../grid";
import { cellCorner, type View } from "../view";

export type EditsData = {
  readonly size: GridSize;
  readonly stroke: Draft;
  readonly pending: readonly Draft[];
  readonly refused: Draft;
};

/** Edits that the service has not confirmed: a wall hatched, a taken wall cleared, both framed; refused ones in their own colour. */
export function drawEdits(context: Draw, view: View, data: EditsData, palette: Palette): void {
  const paint = (draft: Draft, colour: string, dash: number[]) => {
    isolated(context, () => {
      context.strokeStyle = colour;
      context.lineWidth = view.scale >= 8 ? 2 : 1;
      context.setLineDash(dash);
      for (const [index, wall] of draft) {
        drawEdit(context, view, cellCorner(view, cellOfIndex(data.size, index)), wall, palette);
      }
    });
  };
  paint(data.refused, palette.refused, []);
  for (const draft of data.pending) paint(draft, palette.draft, [3, 3]);
  paint(data.stroke, palette.draft, []);
}

function drawEdit(
  context: Draw,
  view: View,
  corner: { x: number; y: number },
  wall: boolean,
  palette: Palette,
): void {
  const inset = Math.min(2, 0.08 * view.scale);
  const size = view.scale - 2 * inset;
  const inner = { x: corner.x + inset, y: corner.y + inset };
  context.fillStyle = wall ? palette.wall : palette.free;
  context.globalAlpha = wall ? 0.55 : 0.85;
  context.fillRect(corner.x, corner.y, view.scale, view.scale);
  context.globalAlpha = 1;
  context.beginPath();
  context.rect(inner.x, inner.y, size, size);
  if (wall && view.scale >= 8) hatchPath(context, inner, size, false);
  context.stroke();
}
