/** What drawing needs of a 2D context, so that tests can record it. Units: CSS pixels; the caller sets the pixel ratio. */
export type Draw = Pick<
  CanvasRenderingContext2D,
  | "save"
  | "restore"
  | "beginPath"
  | "closePath"
  | "moveTo"
  | "lineTo"
  | "arc"
  | "rect"
  | "fill"
  | "stroke"
  | "clip"
  | "fillRect"
  | "strokeRect"
  | "clearRect"
  | "fillText"
  | "strokeText"
  | "setLineDash"
  | "drawImage"
  | "fillStyle"
  | "strokeStyle"
  | "lineWidth"
  | "lineCap"
  | "lineJoin"
  | "globalAlpha"
  | "font"
  | "textAlign"
  | "textBaseline"
  | "imageSmoothingEnabled"
> & { measureText(text: string): { width: number } };

/** Draws with what `draw` sets, and leaves nothing of it behind. */
export function isolated(context: Draw, draw: () => void): void {
  context.save();
  draw();
  context.restore();
}
