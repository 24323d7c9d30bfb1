import { inWords } from "../../app/words";
import type { GoalPose, World } from "../../protocol/generated/console_pb";
import { type Draw, isolated } from "../draw/context";
import { inkOn, type Palette } from "../draw/palette";
import { arrowHead, font, haloStroke, haloText, shapePath } from "../draw/shapes";
import type { Cell, MapRobot } from "../map_props";
import { cellCentre, cellCorner, type Point, positionPoint, showsDetail, type View } from "../view";
import { markRadius } from "./paths";

type RobotsData = {
  readonly world: World;
  readonly robots: readonly MapRobot[];
  readonly chosen: string | undefined;
};

export function robotPoint(view: View, world: World, one: MapRobot): Point {
  return positionPoint(view, world, one.robot);
}

/** Each robot in its colour and shape, with letter and heading. Stopped: a red square. Stale: dashed rim. Lost or unknown: hollow, with a question mark. */
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
  isolated(context, () => drawLetters(context, view, data, palette));
}

/** Setting a font costs as much as drawing a robot: once for all. */
function drawLetters(context: Draw, view: View, data: RobotsData, palette: Palette): void {
  const radius = markRadius(view);
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.font = font(Math.round(Math.max(8, 0.95 * radius)), 700);
  for (const one of data.robots) {
    const at = robotPoint(view, data.world, one);
    context.fillStyle = isLost(one) ? palette.ink : inkOn(one.colour);
    context.fillText(one.letter, at.x, at.y + 0.5);
  }
  if (!showsDetail(view)) return;
  context.font = font(11);
  context.textBaseline = "top";
  for (const one of data.robots) {
    drawName(context, robotPoint(view, data.world, one), radius, one, palette);
  }
}

function isLost({ fresh }: MapRobot): boolean {
  return fresh === "lost" || fresh === "unknown";
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
  if (lost) drawQuestion(context, at, radius, palette);
  if (one.stopped) drawStopped(context, at, radius, palette);
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
  const words = [...(one.stopped ? ["stopped"] : []), ...(one.fresh === "live" ? [] : [one.fresh])];
  const age = words.length === 0 ? "" : ` (${words.map(inWords).join(", ")})`;
  const below = { x: at.x, y: at.y + radius + 4 };
  context.setLineDash([]);
  haloText(context, one.robot.name + age, below, palette.ink, palette);
}

function drawQuestion(context: Draw, at: Point, radius: number, palette: Palette): void {
  context.font = font(14, 700);
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.setLineDash([]);
  const corner = { x: at.x + 1.1 * radius, y: at.y - 1.1 * radius };
  haloText(context, "?", corner, palette.refused, palette);
}

/** A square, as on the button that stops. */
function drawStopped(context: Draw, at: Point, radius: number, palette: Palette): void {
  const side = Math.max(7, 0.8 * radius);
  context.setLineDash([]);
  context.fillStyle = palette.refused;
  context.strokeStyle = palette.halo;
  context.lineWidth = 2;
  context.beginPath();
  context.rect(at.x - radius - side / 2, at.y - radius - side / 2, side, side);
  context.fill();
  context.stroke();
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

/** A flag in the robot's colour at each goal; hollow and ticked if reached. */
export function drawGoals(
  context: Draw,
  view: View,
  robots: readonly MapRobot[],
  palette: Palette,
): void {
  isolated(context, () => {
    context.lineJoin = "round";
    context.lineCap = "round";
    for (const one of robots) {
      for (const cell of one.robot.goalsReached) drawFlag(context, view, cell, one, true, palette);
      for (const cell of one.robot.goalsLeft) drawFlag(context, view, cell, one, false, palette);
    }
  });
}

function drawFlag(
  context: Draw,
  view: View,
  cell: Cell,
  one: MapRobot,
  reached: boolean,
  palette: Palette,
): void {
  const corner = cellCorner(view, cell);
  const size = Math.max(14, Math.min(34, 0.74 * view.scale));
  const foot = {
    x: corner.x + view.scale / 2 - 0.3 * size,
    y: corner.y + view.scale / 2 + size / 2,
  };
  const cloth = { width: 0.72 * size, height: 0.56 * size };
  const outline = () => {
    context.beginPath();
    context.moveTo(foot.x, foot.y);
    context.lineTo(foot.x, foot.y - size);
    context.lineTo(foot.x + cloth.width, foot.y - size + 0.12 * size);
    context.lineTo(foot.x + 0.82 * cloth.width, foot.y - size + cloth.height / 2);
    context.lineTo(foot.x + cloth.width, foot.y - size + cloth.height - 0.02 * size);
    context.lineTo(foot.x, foot.y - size + cloth.height);
  };
  outline();
  context.strokeStyle = palette.halo;
  context.lineWidth = 4;
  context.stroke();
  context.fillStyle = reached ? palette.free : one.colour;
  context.fill();
  context.strokeStyle = reached ? one.colour : palette.ink;
  context.lineWidth = reached ? 1.8 : 1.3;
  outline();
  context.stroke();
  const middle = { x: foot.x + 0.42 * cloth.width, y: foot.y - size + 0.52 * cloth.height };
  if (reached) drawTick(context, middle, 0.3 * cloth.height, palette);
  else if (showsDetail(view)) drawLetter(context, middle, one, 0.66 * cloth.height);
}

function drawTick(
  context: Draw,
  at: { x: number; y: number },
  reach: number,
  palette: Palette,
): void {
  context.strokeStyle = palette.ink;
  context.lineWidth = 2;
  context.beginPath();
  context.moveTo(at.x - reach, at.y);
  context.lineTo(at.x - 0.2 * reach, at.y + 0.8 * reach);
  context.lineTo(at.x + reach, at.y - 0.8 * reach);
  context.stroke();
}

/** In the colour that reads best on the robot's own. `size`: px. */
export function drawLetter(
  context: Draw,
  at: { x: number; y: number },
  one: MapRobot,
  size: number,
): void {
  context.font = font(Math.max(7, size), 700);
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillStyle = inkOn(one.colour);
  context.fillText(one.letter, at.x, at.y);
}

type GoalPosesData = {
  readonly robots: readonly MapRobot[];
  readonly goalPoses: ReadonlyMap<string, GoalPose>;
};

/** A target at each goal pose that another program, such as RViz, has sent. */
export function drawGoalPoses(
  context: Draw,
  view: View,
  data: GoalPosesData,
  palette: Palette,
): void {
  isolated(context, () => {
    for (const { robot, colour } of data.robots) {
      const cell = data.goalPoses.get(robot.name)?.cell;
      if (!cell) continue;
      const at = cellCentre(view, cell);
      const radius = Math.max(6, Math.min(14, 0.32 * view.scale));
      haloStroke(context, colour, 2, palette, () => {
        context.beginPath();
        context.arc(at.x, at.y, radius, 0, 2 * Math.PI);
        for (const [dx, dy] of [
          [1, 0],
          [-1, 0],
          [0, 1],
          [0, -1],
        ] as const) {
          context.moveTo(at.x + 0.5 * radius * dx, at.y + 0.5 * radius * dy);
          context.lineTo(at.x + 1.4 * radius * dx, at.y + 1.4 * radius * dy);
        }
        context.stroke();
      });
      if (!showsDetail(view)) continue;
      context.font = font(11);
      context.textAlign = "center";
      context.textBaseline = "top";
      const below = { x: at.x, y: at.y + 1.4 * radius + 2 };
      haloText(context, `${robot.name} goal pose`, below, palette.ink, palette);
    }
  });
}
