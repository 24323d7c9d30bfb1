import type { GridSize } from "../grid";
import type { View } from "../view";
import { sameValues } from "./cached_layer";
import { type Draw, isolated } from "./context";

/** One pixel per cell, painted when its data changes and stretched over the grid in each frame. */
export type Bitmap = { readonly image: CanvasImageSource; readonly keys: readonly unknown[] };

/** The bitmap of before if its keys are still the same; otherwise a new one. */
export function bitmapOf(
  before: Bitmap | undefined,
  size: GridSize,
  keys: readonly unknown[],
  paint: (context: Draw) => void,
): Bitmap | undefined {
  if (before && sameValues(before.keys, keys)) return before;
  const image = document.createElement("canvas");
  image.width = size.columns;
  image.height = size.rows;
  const context = image.getContext("2d");
  if (!context) return undefined;
  paint(context);
  return { image, keys };
}

export function drawBitmap(
  context: Draw,
  view: View,
  size: GridSize,
  bitmap: Bitmap | undefined,
): void {
  if (!bitmap) return;
  isolated(context, () => {
    context.imageSmoothingEnabled = false;
    context.drawImage(
      bitmap.image,
      view.x,
      view.y,
      size.columns * view.scale,
      size.rows * view.scale,
    );
  });
}
