import type { Draw } from "./context";
import { colourNames, type Palette, paletteFrom } from "./palette";

/** One call of a recording context, with the styles at that time. */
type Call = {
  readonly name: string;
  readonly values: readonly unknown[];
  readonly fill: unknown;
  readonly stroke: unknown;
};

/** For tests: a context that draws nothing and records all calls. */
export class RecordingContext implements Draw {
  readonly calls: Call[] = [];
  fillStyle: string | CanvasGradient | CanvasPattern = "";
  strokeStyle: string | CanvasGradient | CanvasPattern = "";
  lineWidth = 1;
  lineCap: CanvasLineCap = "butt";
  lineJoin: CanvasLineJoin = "miter";
  globalAlpha = 1;
  font = "";
  textAlign: CanvasTextAlign = "start";
  textBaseline: CanvasTextBaseline = "alphabetic";
  imageSmoothingEnabled = true;

  save = this.#recorder("save");
  restore = this.#recorder("restore");
  beginPath = this.#recorder("beginPath");
  closePath = this.#recorder("closePath");
  moveTo = this.#recorder("moveTo");
  lineTo = this.#recorder("lineTo");
  arc = this.#recorder("arc");
  rect = this.#recorder("rect");
  fill = this.#recorder("fill");
  stroke = this.#recorder("stroke");
  clip = this.#recorder("clip");
  fillRect = this.#recorder("fillRect");
  strokeRect = this.#recorder("strokeRect");
  clearRect = this.#recorder("clearRect");
  fillText = this.#recorder("fillText");
  strokeText = this.#recorder("strokeText");
  setLineDash = this.#recorder("setLineDash");
  drawImage = this.#recorder("drawImage");

  measureText(text: string): { width: number } {
    return { width: 7 * text.length };
  }

  named(name: string): Call[] {
    return this.calls.filter((call) => call.name === name);
  }

  texts(): unknown[] {
    return this.named("fillText").map((call) => call.values[0]);
  }

  #recorder(name: string): (...values: unknown[]) => void {
    return (...values) => {
      this.calls.push({ name, values, fill: this.fillStyle, stroke: this.strokeStyle });
    };
  }
}

/** A palette in which each colour is its own name. */
export const namedPalette: Palette = paletteFrom((name) => {
  if (!colourNames.includes(name)) throw new Error(`no colour ${name}`);
  return name;
});
