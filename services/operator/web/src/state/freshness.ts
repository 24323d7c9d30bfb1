import type { Freshness } from "../map/map_props";

export type { Freshness } from "../map/map_props";

/** s of wall time since a robot's newest state. */
export const staleAfter = 1;
const lostAfter = 3;

/** s; an older frame is no longer a live view. */
export const frameStaleAfter = 1;

/** s since `heardAt`, both wall time; undefined while either is unknown. Never negative, although clocks differ a little. */
export function ageOf(heardAt: number | undefined, now: number | undefined): number | undefined {
  return heardAt === undefined || heardAt === 0 || now === undefined
    ? undefined
    : Math.max(0, now - heardAt);
}

/** A robot without any state is lost. `linked`: whether the link is live; without it nothing is known. */
export function freshnessOf(
  heardAt: number | undefined,
  now: number | undefined,
  linked: boolean,
): Freshness {
  if (!linked) return "unknown";
  const age = ageOf(heardAt, now);
  if (age === undefined || age >= lostAfter) return "lost";
  return age >= staleAfter ? "stale" : "live";
}
