import { type Draw, isolated } from "../draw/context";
import { inkOn, type Palette } from "../draw/palette";
import { font } from "../draw/shapes";
import type { Cell, MapRobot } from "../map_props";
import { cellCorner, showsDetail, type View } from "../view";

/** A flag in the robot's colour at each goal; one that is reached is hollow and ticked. */
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

function drawLetter(
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
