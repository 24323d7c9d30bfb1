import { type Draw, isolated } from "../draw/context";
import type { Palette } from "../draw/palette";
import { polyline } from "../draw/shapes";
import type { Cell, MapRobot } from "../map_props";
import type { View } from "../view";
import { lanePoints, laneShift } from "./lanes";

export type TrailsData = {
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
