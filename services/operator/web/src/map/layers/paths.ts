import type { Guidance } from "../../protocol/generated/console_pb";
import { type Draw, isolated } from "../draw/context";
import type { Palette } from "../draw/palette";
import { arrowHead, font, haloStroke, haloText, polyline } from "../draw/shapes";
import type { Cell, MapRobot } from "../map_props";
import { type Point, showsDetail, type View } from "../view";
import { lanePoints, laneShift } from "./lanes";

export type PathsData = {
  readonly robots: readonly MapRobot[];
  readonly guidance: ReadonlyMap<string, Guidance>;
  readonly hidden: string | undefined; // a robot whose path is being drawn anew
};

/** The paths that the robots were given: each in its robot's colour and dash, with arrow heads and the robot's name. */
export function drawPaths(context: Draw, view: View, data: PathsData, palette: Palette): void {
  data.robots.forEach((one, index) => {
    const path = data.guidance.get(one.robot.name)?.path ?? [];
    if (path.length < 2) return;
    const points = lanePoints(view, path, laneShift(data.robots, index, view));
    isolated(context, () => {
      context.globalAlpha = one.robot.name === data.hidden ? 0.35 : 1;
      drawPath(context, view, points, one, palette);
    });
  });
}

/** The robots' names where their paths end; apart from the lines, so that flags do not cover them. */
export function drawPathNames(context: Draw, view: View, data: PathsData, palette: Palette): void {
  if (!showsDetail(view)) return;
  data.robots.forEach(({ robot: { name } }, index) => {
    const path = data.guidance.get(name)?.path ?? [];
    if (path.length < 2 || name === data.hidden) return;
    const points = lanePoints(view, path, laneShift(data.robots, index, view));
    isolated(context, () => drawName(context, view, points, name, palette));
  });
}

function pathWidth(view: View): number {
  return Math.max(2, Math.min(5, 0.12 * view.scale));
}

/** A line with arrow heads along it, so that its direction reads at every zoom. */
function drawPath(
  context: Draw,
  view: View,
  points: readonly Point[],
  one: { colour: string; dash: readonly number[] },
  palette: Palette,
): void {
  context.lineJoin = "round";
  const width = pathWidth(view);
  haloStroke(context, one.colour, width, palette, () => {
    context.setLineDash(context.strokeStyle === palette.halo ? [] : [...one.dash]);
    polyline(context, points);
  });
  context.setLineDash([]);
  context.fillStyle = one.colour;
  const every = Math.max(1, Math.round(70 / view.scale));
  points.forEach((point, index) => {
    const before = points[index - 1];
    const last = index === points.length - 1;
    if (!before || (!last && (index % every !== 0 || points.length - 1 - index < every / 2)))
      return;
    drawHead(context, before, point, last ? 0 : 0.5, 2 * width + 5, palette);
  });
}

function drawHead(
  context: Draw,
  from: Point,
  to: Point,
  back: number,
  size: number,
  palette: Palette,
): void {
  const angle = Math.atan2(to.y - from.y, to.x - from.x);
  const tip = {
    x: to.x - back * (to.x - from.x) + 0.4 * size * Math.cos(angle),
    y: to.y - back * (to.y - from.y) + 0.4 * size * Math.sin(angle),
  };
  arrowHead(context, tip, angle, size);
  context.strokeStyle = palette.halo;
  context.lineWidth = 1;
  context.stroke();
}

function drawName(
  context: Draw,
  view: View,
  points: readonly Point[],
  name: string,
  palette: Palette,
): void {
  const end = points.at(-1);
  if (!end) return;
  context.font = font(12, 700);
  context.textAlign = "center";
  context.textBaseline = "middle";
  const at = { x: end.x, y: end.y + Math.max(14, 0.4 * view.scale) };
  haloText(context, name, at, palette.ink, palette);
}

export type DraftPathData = {
  readonly robot: MapRobot;
  readonly cells: readonly Cell[];
  readonly vertices: readonly number[];
  readonly sent: boolean; // on its way to the service
  readonly trouble: readonly Cell[]; // walls that it crosses
  readonly shift: number;
};

/** The path being drawn: dashed until the service has it, with its corners to drag, walls that it crosses ringed. */
export function drawDraftPath(
  context: Draw,
  view: View,
  data: DraftPathData,
  palette: Palette,
): void {
  const points = lanePoints(view, data.cells, data.shift);
  isolated(context, () => {
    context.globalAlpha = data.sent ? 0.6 : 1;
    drawPath(context, view, points, { colour: data.robot.colour, dash: [8, 5] }, palette);
    if (showsDetail(view)) drawName(context, view, points, data.robot.robot.name, palette);
    const radius = pathWidth(view) + 1.5;
    for (const vertex of data.sent ? [] : data.vertices) {
      const at = points[vertex];
      if (!at || vertex === 0) continue;
      context.beginPath();
      context.arc(at.x, at.y, radius, 0, 2 * Math.PI);
      context.fillStyle = palette.free;
      context.fill();
      context.strokeStyle = data.robot.colour;
      context.lineWidth = 2.5;
      context.stroke();
    }
    for (const at of lanePoints(view, data.trouble, 0)) drawTrouble(context, view, at, palette);
  });
}

function drawTrouble(context: Draw, view: View, at: Point, palette: Palette): void {
  const reach = Math.max(4, Math.min(10, 0.28 * view.scale));
  haloStroke(context, palette.refused, 2.5, palette, () => {
    context.beginPath();
    context.moveTo(at.x - reach, at.y - reach);
    context.lineTo(at.x + reach, at.y + reach);
    context.moveTo(at.x + reach, at.y - reach);
    context.lineTo(at.x - reach, at.y + reach);
    context.stroke();
  });
}
