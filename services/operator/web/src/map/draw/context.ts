/** The part of a 2D context that drawing uses, so that tests can record it. In CSS pixels; the caller sets the pixel ratio. */
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

/** Runs `draw` and restores the context's state afterwards. */
export function isolated(context: Draw, draw: () => void): void {
  context.save();
  draw();
  context.restore();
}
