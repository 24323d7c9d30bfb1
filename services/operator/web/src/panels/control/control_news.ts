import type { ConsoleState } from "../../state/console_state";
import { holderOf } from "../../state/selectors";
import { duration } from "../format";

/** s; control that ends earlier than this before its time was released by hand. */
const nearlyOver = 1;

/** What whoever had control of robots must hear: that somebody took over, or that it ran out. `now`: wall time of the service. */
export function controlNews(before: ConsoleState, after: ConsoleState, now: number): string[] {
  if (before.run !== after.run || before.controls === after.controls) return [];
  const robots = new Map<string, string[]>();
  for (const robot of before.controls.keys()) {
    const why = whyLost(before, after, robot, now);
    if (why !== undefined) robots.set(why, [...(robots.get(why) ?? []), robot]);
  }
  return [...robots].map(([why, names]) => `You control ${names.join(", ")} no more: ${why}`);
}

function whyLost(
  before: ConsoleState,
  after: ConsoleState,
  robot: string,
  now: number,
): string | undefined {
  const had = holderOf(before, robot);
  const has = holderOf(after, robot);
  if (had.kind !== "me" || has.kind === "me") return undefined;
  if (has.kind === "other") return `${has.name} took over${has.reason && ` (“${has.reason}”)`}.`;
  if (had.until - now > nearlyOver) return undefined;
  const limit = after.welcome?.limits?.controlTime;
  return `nobody used this page for ${duration(limit)}. “Take control” gives it back.`;
}
