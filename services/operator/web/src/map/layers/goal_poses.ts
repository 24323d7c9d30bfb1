import type { GoalPose } from "../../protocol/generated/console_pb";
import { type Draw, isolated } from "../draw/context";
import type { Palette } from "../draw/palette";
import { font, haloStroke, haloText } from "../draw/shapes";
import type { MapRobot } from "../map_props";
import { cellCentre, showsDetail, type View } from "../view";

export type GoalPosesData = {
  readonly robots: readonly MapRobot[];
  readonly goalPoses: ReadonlyMap<string, GoalPose>;
};

/** A target where somebody else, such as RViz, sends a robot. */
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
