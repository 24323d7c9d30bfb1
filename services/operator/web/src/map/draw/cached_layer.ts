import type { View } from "../view";
import type { Draw } from "./context";

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
