import type { Freshness } from "../map/map_props";

export type { Freshness } from "../map/map_props";

/** s of wall time since a robot's newest state. */
export const staleAfter = 1;
const lostAfter = 3;

/** s; an older frame is no longer a live view. */
export const frameStaleAfter = 1;

/** s since `receivedAt`, both wall time; undefined while either is unknown. Never negative, although clocks differ a little. */
export function ageOf(receivedAt: number | undefined, now: number | undefined): number | undefined {
  return receivedAt === undefined || receivedAt === 0 || now === undefined
    ? undefined
    : Math.max(0, now - receivedAt);
}

/** A robot without any state is lost. `linked`: whether the link is live; without it nothing is known. */
export function freshnessOf(
  receivedAt: number | undefined,
  now: number | undefined,
  linked: boolean,
): Freshness {
  if (!linked) return "unknown";
  const age = ageOf(receivedAt, now);
  if (age === undefined || age >= lostAfter) return "lost";
  return age >= staleAfter ? "stale" : "live";
}
