import type { Plan } from "../../protocol/generated/console_pb";
import { type Draw, isolated } from "../draw/context";
import type { Palette } from "../draw/palette";
import type { MapRobot } from "../map_props";
import type { View } from "../view";
import { lanePoints, laneShift } from "./lanes";

export type PlansData = {
  readonly robots: readonly MapRobot[];
  readonly plans: ReadonlyMap<string, Plan>;
};

/** The cells that each robot means to enter next: dots that grow smaller with the distance, the first ones ringed. */
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
