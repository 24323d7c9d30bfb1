import type { View } from "../view";
import { type Draw, isolated } from "./context";

type Paint = (context: Draw) => void;

/**
 * A part of the frame that changes rarely: drawn on its own canvas when it changes, and copied into each frame. While the view
 * moves it is painted right into the frame, which is cheaper than a copy of each.
 */
export class CachedLayer {
  #canvas: HTMLCanvasElement | undefined;
  #keys: readonly unknown[] = [];
  #view: View | undefined;

  /**
   * `keys`: all data that `paint` uses besides the view, compared by identity. While they stay the same, `add` may draw more on
   * top. Without a canvas, paints directly.
   */
  draw(onto: Draw, view: View, keys: readonly unknown[], paint: Paint, add?: Paint): void {
    const moved = view !== this.#view;
    this.#view = view;
    if (moved) {
      this.#keys = [];
      paint(onto);
      return;
    }
    const ratio = devicePixelRatio;
    const now = [ratio, ...keys];
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

/** An empty drawing surface of the view's size, and its image. */
type Surface = { readonly on: Draw; readonly image: CanvasImageSource };
type MakeSurface = (view: View) => Surface | undefined;

/** Draws a layer with an opacity as a whole, so that overlapping parts of it do not add up. */
export class Fader {
  readonly #surface: MakeSurface;

  constructor(surface: MakeSurface = canvasSurface()) {
    this.#surface = surface;
  }

  /** `strength`: opacity from 0 to 1. Without a surface the layer is opaque. */
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

/** One canvas, shared by all layers in turn. */
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
