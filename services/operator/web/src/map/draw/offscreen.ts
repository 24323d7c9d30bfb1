import type { GridSize } from "../grid";
import type { View } from "../view";
import { type Draw, isolated } from "./context";

type Paint = (context: Draw) => void;

/** Part of a frame that changes more seldom than the rest: drawn on a canvas of its own when it changes, and copied in each frame. */
export class CachedLayer {
  #canvas: HTMLCanvasElement | undefined;
  #keys: readonly unknown[] = [];

  /**
   * `keys`: all that `paint` draws from besides the view, compared by identity; while they are the same, `add` may draw more over
   * it. Where there is no canvas all is painted right away.
   */
  draw(onto: Draw, view: View, keys: readonly unknown[], paint: Paint, add?: Paint): void {
    const ratio = devicePixelRatio;
    const now = [view, ratio, ...keys];
    const same = sameValues(this.#keys, now);
    if (!same) this.#canvas = painted(this.#canvas, view, ratio, paint);
    this.#keys = now;
    const canvas = this.#canvas;
    const context = canvas?.getContext("2d");
    if (same && context) add?.(context);
    if (canvas) onto.drawImage(canvas, 0, 0, canvas.width / ratio, canvas.height / ratio);
    else paint(onto);
  }
}

function painted(
  before: HTMLCanvasElement | undefined,
  view: View,
  ratio: number,
  paint: Paint,
): HTMLCanvasElement | undefined {
  const canvas = before ?? document.createElement("canvas");
  // Also clears it.
  canvas.width = Math.round(view.width * ratio);
  canvas.height = Math.round(view.height * ratio);
  const context = canvas.getContext("2d");
  if (!context) return undefined;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  paint(context);
  return canvas;
}

export function sameValues(a: readonly unknown[], b: readonly unknown[]): boolean {
  return a.length === b.length && a.every((value, i) => value === b[i]);
}

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

/** Something of the size of the view to draw on, empty, and how it is shown then. */
type Surface = { readonly on: Draw; readonly image: CanvasImageSource };
type MakeSurface = (view: View) => Surface | undefined;

/** Draws a layer as a whole more or less strongly: what lies over itself in it does not shine through. */
export class Fader {
  readonly #surface: MakeSurface;

  constructor(surface: MakeSurface = canvasSurface()) {
    this.#surface = surface;
  }

  /** `strength`: 0 = not at all, 1 = fully. Where there is nothing else to draw on it is drawn fully. */
  draw(onto: Draw, view: View, strength: number, paint: (on: Draw) => void): void {
    if (strength <= 0) return;
    const surface = strength < 1 ? this.#surface(view) : undefined;
    paint(surface?.on ?? onto);
    if (!surface) return;
    isolated(onto, () => {
      onto.globalAlpha = strength;
      onto.drawImage(surface.image, 0, 0, view.width, view.height);
    });
  }
}

/** One canvas for all layers, one after another. */
function canvasSurface(): MakeSurface {
  let kept: HTMLCanvasElement | undefined;
  return ({ width, height }) => {
    kept ??= document.createElement("canvas");
    // Also clears it.
    kept.width = Math.round(width * devicePixelRatio);
    kept.height = Math.round(height * devicePixelRatio);
    const on = kept.getContext("2d");
    on?.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
    return on ? { on, image: kept } : undefined;
  };
}
