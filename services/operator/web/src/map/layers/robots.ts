import type { World } from "../../protocol/generated/console_pb";
import { type Draw, isolated } from "../draw/context";
import { inkOn, type Palette } from "../draw/palette";
import { arrowHead, font, haloText, shapePath } from "../draw/shapes";
import type { MapRobot } from "../map_props";
import { type Point, positionPoint, showsDetail, type View } from "../view";
import { markRadius } from "./lanes";

export type RobotsData = {
  readonly world: World;
  readonly robots: readonly MapRobot[];
  readonly chosen: string | undefined;
};

export function robotPoint(view: View, world: World, one: MapRobot): Point {
  return positionPoint(view, world, world.cellSize, one.robot);
}

/**
 * Each robot in its colour and shape, with its letter and heading. Stale: dashed rim. Lost, or nobody can be heard: hollow, with
 * a question mark.
 */
export function drawRobots(context: Draw, view: View, data: RobotsData, palette: Palette): void {
  const chosenLast = [...data.robots].sort(
    (a, b) => Number(a.robot.name === data.chosen) - Number(b.robot.name === data.chosen),
  );
  for (const one of chosenLast) {
    const at = robotPoint(view, data.world, one);
    isolated(context, () => drawRobot(context, view, at, one, palette));
    if (one.robot.name !== data.chosen) continue;
    isolated(context, () => drawChosen(context, at, markRadius(view), palette));
  }
}

function isLost({ fresh }: MapRobot): boolean {
  return fresh === "lost" || fresh === "no news";
}

function drawRobot(context: Draw, view: View, at: Point, one: MapRobot, palette: Palette): void {
  const radius = markRadius(view);
  const lost = isLost(one);
  drawHeading(context, at, one, radius, palette);
  shapePath(context, one.shape, at, radius);
  context.strokeStyle = palette.halo;
  context.lineWidth = 5;
  context.stroke();
  context.fillStyle = lost ? palette.free : one.colour;
  context.fill();
  context.strokeStyle = lost ? palette.muted : palette.ink;
  context.lineWidth = 1.5;
  context.setLineDash(one.fresh === "live" ? [] : [3, 3]);
  context.stroke();
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.font = font(Math.round(Math.max(8, 0.95 * radius)), 700);
  context.fillStyle = lost ? palette.ink : inkOn(one.colour);
  context.fillText(one.letter, at.x, at.y + 0.5);
  if (lost) drawQuestion(context, at, radius, palette);
  if (showsDetail(view)) drawName(context, at, radius, one, palette);
}

function drawHeading(
  context: Draw,
  at: Point,
  one: MapRobot,
  radius: number,
  palette: Palette,
): void {
  const angle = -one.robot.heading;
  const tip = {
    x: at.x + (radius + 11) * Math.cos(angle),
    y: at.y + (radius + 11) * Math.sin(angle),
  };
  context.fillStyle = isLost(one) ? palette.muted : one.colour;
  context.lineJoin = "round";
  arrowHead(context, tip, angle, 13);
  context.strokeStyle = palette.halo;
  context.lineWidth = 3;
  context.stroke();
  arrowHead(context, tip, angle, 13);
  context.strokeStyle = palette.ink;
  context.lineWidth = 1;
  context.stroke();
}

function drawName(context: Draw, at: Point, radius: number, one: MapRobot, palette: Palette): void {
  context.font = font(11);
  context.textBaseline = "top";
  const age = one.fresh === "live" ? "" : ` (${one.fresh})`;
  const below = { x: at.x, y: at.y + radius + 4 };
  context.setLineDash([]);
  haloText(context, one.robot.name + age, below, palette.ink, palette);
}

function drawQuestion(context: Draw, at: Point, radius: number, palette: Palette): void {
  context.font = font(14, 700);
  context.setLineDash([]);
  const beside = { x: at.x + 1.1 * radius, y: at.y - 1.1 * radius };
  haloText(context, "?", beside, palette.refused, palette);
}

function drawChosen(context: Draw, at: Point, radius: number, palette: Palette): void {
  context.beginPath();
  context.arc(at.x, at.y, radius + 15, 0, 2 * Math.PI);
  context.strokeStyle = palette.halo;
  context.lineWidth = 5;
  context.stroke();
  context.strokeStyle = palette.focus;
  context.lineWidth = 3;
  context.stroke();
}
