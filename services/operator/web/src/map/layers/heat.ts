import type { Prediction } from "../../protocol/generated/console_pb";
import { type Draw, isolated } from "../draw/context";
import type { Palette } from "../draw/palette";
import { hatchPath } from "../draw/shapes";
import type { GridSize } from "../grid";
import { cellCorner, showsDetail, type View } from "../view";
import { eachVisible } from "./cells";

export type HeatData = { readonly size: GridSize; readonly predictions: Iterable<Prediction> };

const leastShown = 10; // of 255

/** Edits that the model expects of the operator: rising lines = a wall is added, falling = taken away. */
export function drawHeat(context: Draw, view: View, data: HeatData, palette: Palette): void {
  isolated(context, () => {
    for (const { add, remove } of data.predictions) {
      eachVisible(view, data.size, (cell, index) => {
        const corner = cellCorner(view, cell);
        heatCell(context, corner, view, add[index] ?? 0, palette.add, false);
        heatCell(context, corner, view, remove[index] ?? 0, palette.remove, true);
      });
    }
  });
}

function heatCell(
  context: Draw,
  corner: { x: number; y: number },
  view: View,
  value: number,
  colour: string,
  falling: boolean,
): void {
  if (value < leastShown) return;
  context.fillStyle = colour;
  context.strokeStyle = colour;
  context.globalAlpha = 0.12 + 0.5 * (value / 255);
  context.fillRect(corner.x, corner.y, view.scale, view.scale);
  if (!showsDetail(view)) return;
  context.globalAlpha = 0.35 + 0.65 * (value / 255);
  context.lineWidth = 1.5;
  context.beginPath();
  hatchPath(context, corner, view.scale, falling);
  context.stroke();
}
