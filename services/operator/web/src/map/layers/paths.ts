import type { Plan } from "../../protocol/generated/console_pb";
import { type Draw, isolated } from "../draw/context";
import type { Palette } from "../draw/palette";
import { arrowHead, font, haloStroke, haloText, polyline } from "../draw/shapes";
import type { Cell, MapRobot } from "../map_props";
import { cellCentre, type Point, showsDetail, type View } from "../view";

export type PathsData = {
  readonly robots: readonly MapRobot[];
  /** What is left of each robot's path. */
  readonly paths: ReadonlyMap<string, readonly Cell[]>;
  readonly hidden: string | undefined; // a robot whose path is being redrawn
};

/** The robots' paths, each in its robot's colour and dash, with arrow heads. */
export function drawPaths(context: Draw, view: View, data: PathsData, palette: Palette): void {
  data.robots.forEach((one, index) => {
    const path = data.paths.get(one.robot.name) ?? [];
    if (path.length < 2) return;
    const points = lanePoints(view, path, laneShift(data.robots, index, view));
    isolated(context, () => {
      context.globalAlpha = one.robot.name === data.hidden ? 0.35 : 1;
      drawPath(context, view, points, one, palette);
    });
  });
}

/** The robots' names at the ends of their paths. A separate pass, so that flags do not cover them. */
export function drawPathNames(context: Draw, view: View, data: PathsData, palette: Palette): void {
  if (!showsDetail(view)) return;
  data.robots.forEach(({ robot: { name } }, index) => {
    const path = data.paths.get(name) ?? [];
    if (path.length < 2 || name === data.hidden) return;
    const points = lanePoints(view, path, laneShift(data.robots, index, view));
    isolated(context, () => drawName(context, view, points, name, palette));
  });
}

function pathWidth(view: View): number {
  return Math.max(2, Math.min(5, 0.12 * view.scale));
}

/** A line with arrow heads along it, so that its direction is visible at every zoom. */
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

type DraftPathData = {
  readonly robot: MapRobot;
  readonly cells: readonly Cell[];
  readonly undrawn: number; // of the first cells, drawn dotted: the way to what the hand drew
  readonly vertices: readonly number[];
  readonly sent: boolean; // on its way to the service
  readonly trouble: readonly Cell[]; // walls that it crosses
  readonly shift: number;
};

/** The path being drawn: dashed until the service has it, with handles at its corners and crosses on walls. */
export function drawDraftPath(
  context: Draw,
  view: View,
  data: DraftPathData,
  palette: Palette,
): void {
  const points = lanePoints(view, data.cells, data.shift);
  isolated(context, () => {
    context.globalAlpha = data.sent ? 0.6 : 1;
    const { colour } = data.robot;
    const join = points.slice(0, data.undrawn + 1);
    if (data.undrawn > 0) drawPath(context, view, join, { colour, dash: [2, 6] }, palette);
    drawPath(context, view, points.slice(data.undrawn), { colour, dash: [8, 5] }, palette);
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

type PlansData = {
  readonly robots: readonly MapRobot[];
  readonly plans: ReadonlyMap<string, Plan>;
};

/** The next cells of each robot's plan: dots that shrink with the distance. */
export function drawPlans(context: Draw, view: View, data: PlansData, palette: Palette): void {
  isolated(context, () => {
    data.robots.forEach(({ robot, colour }, index) => {
      const cells = data.plans.get(robot.name)?.cells ?? [];
      const points = lanePoints(view, cells, laneShift(data.robots, index, view));
      points.forEach((point, step) => {
        const radius = Math.max(1.2, Math.min(5, 0.13 * view.scale) * (1 - step / 24));
        context.beginPath();
        context.arc(point.x, point.y, radius, 0, 2 * Math.PI);
        context.fillStyle = colour;
        context.fill();
        if (view.scale < 14) return;
        context.strokeStyle = palette.halo;
        context.lineWidth = 1;
        context.stroke();
      });
    });
  });
}

type TrailsData = {
  readonly robots: readonly MapRobot[];
  readonly trails: ReadonlyMap<string, readonly Cell[]>;
};

/** Where each robot has been: thin, the start marked by a dot. */
export function drawTrails(context: Draw, view: View, data: TrailsData, _palette: Palette): void {
  isolated(context, () => {
    context.lineJoin = "round";
    context.globalAlpha = 0.75;
    data.robots.forEach(({ robot, colour }, index) => {
      const cells = data.trails.get(robot.name) ?? [];
      const points = lanePoints(view, cells, laneShift(data.robots, index, view));
      context.strokeStyle = colour;
      context.fillStyle = colour;
      context.lineWidth = Math.max(1, Math.min(2, 0.06 * view.scale));
      polyline(context, points);
      const [start] = points;
      if (!start) return;
      context.beginPath();
      context.arc(start.x, start.y, Math.max(2, Math.min(4, 0.1 * view.scale)), 0, 2 * Math.PI);
      context.fill();
    });
  });
}

/** Shift in CSS pixels that puts the lines of several robots side by side. */
export function laneShift(robots: readonly MapRobot[], index: number, view: View): number {
  const spacing = Math.min(5, 0.14 * view.scale);
  return (index - (robots.length - 1) / 2) * spacing;
}

function lanePoints(view: View, cells: readonly Cell[], shift: number): Point[] {
  return cells.map((cell) => {
    const at = cellCentre(view, cell);
    return { x: at.x + shift, y: at.y + shift };
  });
}

/** Radius of a robot's mark: easy to find on a large map, within its cell on a small one. */
export function markRadius(view: View): number {
  return Math.max(7, Math.min(16, 0.34 * view.scale));
}
