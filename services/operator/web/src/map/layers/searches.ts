import type { Search, SearchAction } from "../../protocol/generated/console_pb";
import { type Draw, isolated } from "../draw/context";
import type { Palette } from "../draw/palette";
import { arrow, conePath, font, haloText } from "../draw/shapes";
import type { MapRobot } from "../map_props";
import { cellCentre, type Point, showsDetail, type View } from "../view";

type SearchesData = {
  readonly robots: readonly MapRobot[];
  readonly searches: ReadonlyMap<string, Search>;
};

/**
 * The search behind each robot's newest decision: an arrow per move and a cone per picture, larger with more visits. The chosen
 * action is stronger and shows its share of the visits.
 */
export function drawSearches(
  context: Draw,
  view: View,
  data: SearchesData,
  palette: Palette,
): void {
  isolated(context, () => {
    for (const { robot, colour } of data.robots) {
      const search = data.searches.get(robot.name);
      if (!search?.cell) continue;
      const from = cellCentre(view, search.cell);
      const most = Math.max(1, ...search.actions.map((action) => action.visits));
      const total = search.actions.reduce((sum, action) => sum + action.visits, 0);
      search.actions.forEach((action, index) => {
        const chosen = index === search.chosen;
        context.globalAlpha = chosen ? 0.95 : 0.5;
        context.strokeStyle = colour;
        context.fillStyle = colour;
        const tip = drawAction(context, view, from, action, action.visits / most);
        if (chosen && tip && showsDetail(view)) {
          drawShare(context, tip, action.visits / Math.max(1, total), palette);
        }
      });
    }
  });
}

/** Returns the tip of the drawing; undefined for an action without a place. */
function drawAction(
  context: Draw,
  view: View,
  from: Point,
  action: SearchAction,
  share: number,
): Point | undefined {
  if (action.snapshot) {
    const reach = view.scale * (0.5 + 0.9 * share);
    conePath(context, from, action.heading, 0.5, reach);
    context.lineWidth = 1.5;
    context.stroke();
    const alpha = context.globalAlpha;
    context.globalAlpha = 0.35 * alpha;
    context.fill();
    context.globalAlpha = alpha;
    return {
      x: from.x + reach * Math.cos(action.heading),
      y: from.y - reach * Math.sin(action.heading),
    };
  }
  if (!action.target) return undefined;
  const to = cellCentre(view, action.target);
  context.lineWidth = Math.max(1, 0.2 * view.scale * share);
  arrow(context, from, to, context.lineWidth + Math.max(4, 0.18 * view.scale));
  return to;
}

function drawShare(context: Draw, at: Point, share: number, palette: Palette): void {
  context.globalAlpha = 1;
  context.font = font(11);
  context.textAlign = "center";
  context.textBaseline = "bottom";
  haloText(context, `${Math.round(100 * share)} %`, { x: at.x, y: at.y - 3 }, palette.ink, palette);
}
