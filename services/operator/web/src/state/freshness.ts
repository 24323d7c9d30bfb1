import type { Freshness } from "../map/map_props";

export type { Freshness } from "../map/map_props";

/** s of wall time since a robot said something. */
export const staleAfter = 1;
const lostAfter = 3;

/** A stream's frame older than this is no live view any more. */
export const frameStaleAfter = 1;

/** s since `heardAt`, both wall time; undefined while either is unknown. Clocks differ a little: never below 0. */
export function ageOf(heardAt: number | undefined, now: number | undefined): number | undefined {
  return heardAt === undefined || heardAt === 0 || now === undefined
    ? undefined
    : Math.max(0, now - heardAt);
}

/** Robots that were never heard of are lost. `linked`: whether the service is heard now; what it tells is unknown otherwise, however young. */
export function freshnessOf(
  heardAt: number | undefined,
  now: number | undefined,
  linked: boolean,
): Freshness {
  if (!linked) return "no news";
  const age = ageOf(heardAt, now);
  if (age === undefined || age >= lostAfter) return "lost";
  return age >= staleAfter ? "stale" : "live";
}
