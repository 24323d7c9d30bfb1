import type { RobotShape } from "../map_props";
import type { Point } from "../view";
import type { Draw } from "./context";
import type { Palette } from "./palette";

/** Number of corners by shape; 0 = a circle. */
const counts: Record<RobotShape, number> = {
  circle: 0,
  square: 4,
  triangle: 3,
  diamond: 4,
  pentagon: 5,
  star: 10,
};

/** Corners of a robot's mark around the origin, y downwards, clockwise from the top; none = a circle of radius 1. All shapes have about the same area. */
export function cornersOf(shape: RobotShape): readonly Point[] {
  const count = counts[shape];
  const turn = shape === "square" ? Math.PI / 4 : 0;
  const size = shape === "triangle" ? 1.35 : 1.2;
  const down = shape === "triangle" ? 0.22 : 0;
  return Array.from({ length: count }, (_, corner) => {
    const angle = turn + (2 * Math.PI * corner) / count - Math.PI / 2;
    const reach = shape === "star" && corner % 2 === 1 ? 0.62 * size : size;
    return { x: reach * Math.cos(angle), y: down + reach * Math.sin(angle) };
  });
}

/** The outline of a robot's mark, to fill or stroke. */
export function shapePath(context: Draw, shape: RobotShape, at: Point, radius: number): void {
  context.beginPath();
  const corners = cornersOf(shape);
  if (corners.length === 0) context.arc(at.x, at.y, radius, 0, 2 * Math.PI);
  for (const { x, y } of corners) context.lineTo(at.x + radius * x, at.y + radius * y);
  context.closePath();
}

export function polyline(context: Draw, points: readonly Point[]): void {
  context.beginPath();
  for (const point of points) context.lineTo(point.x, point.y);
  context.stroke();
}

/** A filled head with its tip at `tip`, pointing in direction `angle` of the canvas (0 = right, clockwise). */
export function arrowHead(context: Draw, tip: Point, angle: number, size: number): void {
  const back = (side: number): Point => ({
    x: tip.x - size * Math.cos(angle + side),
    y: tip.y - size * Math.sin(angle + side),
  });
  context.beginPath();
  for (const point of [tip, back(0.5), back(-0.5)]) context.lineTo(point.x, point.y);
  context.closePath();
  context.fill();
}

export function arrow(context: Draw, from: Point, to: Point, headSize: number): void {
  const angle = Math.atan2(to.y - from.y, to.x - from.x);
  const neck = {
    x: to.x - 0.8 * headSize * Math.cos(angle),
    y: to.y - 0.8 * headSize * Math.sin(angle),
  };
  polyline(context, [from, neck]);
  arrowHead(context, to, angle, headSize);
}

/** A camera's field of view: heading in radians, 0 = east, counter-clockwise. */
export function conePath(
  context: Draw,
  at: Point,
  heading: number,
  fieldOfView: number,
  reach: number,
): void {
  context.beginPath();
  context.moveTo(at.x, at.y);
  context.arc(at.x, at.y, reach, -heading - fieldOfView / 2, -heading + fieldOfView / 2);
  context.closePath();
}

/** Diagonal lines in a square, rising or falling, so that fills differ without colour. One path; the caller strokes. */
export function hatchPath(context: Draw, corner: Point, size: number, falling: boolean): void {
  const { x, y } = corner;
  const step = Math.max(4, size / 4);
  for (let at = step / 2; at < 2 * size; at += step) {
    const near = Math.max(0, at - size);
    const far = Math.min(size, at);
    context.moveTo(x + near, falling ? y + size - far : y + far);
    context.lineTo(x + far, falling ? y + size - near : y + near);
  }
}

export function font(size: number, weight = 600): string {
  return `${weight} ${size}px "Inter Variable", system-ui, sans-serif`;
}

/** Text with a rim in the halo colour, readable on any background. */
export function haloText(
  context: Draw,
  text: string,
  at: Point,
  colour: string,
  palette: Palette,
): void {
  context.lineJoin = "round";
  context.lineWidth = 3;
  context.strokeStyle = palette.halo;
  context.strokeText(text, at.x, at.y);
  context.fillStyle = colour;
  context.fillText(text, at.x, at.y);
}

/** Strokes twice, first wider in the halo colour, so that the line is visible on free cells and walls. */
export function haloStroke(
  context: Draw,
  colour: string,
  width: number,
  palette: Palette,
  stroke: () => void,
): void {
  context.strokeStyle = palette.halo;
  context.lineWidth = width + 2;
  stroke();
  context.strokeStyle = colour;
  context.lineWidth = width;
  stroke();
}
