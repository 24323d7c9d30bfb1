import type { View } from "../view";
import { type Draw, isolated } from "./context";

/** Something of the size of the view to draw on, empty, and how it is shown then. */
export type Surface = { readonly on: Draw; readonly image: CanvasImageSource };
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
