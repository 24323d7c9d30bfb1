import { Level, type Search, type Service } from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";

/** Duration of the slowest robot's newest decision in s. */
export function plannerTime(searches: ReadonlyMap<string, Search>): number | undefined {
  const times = [...searches.values()].map(({ durationMs }) => durationMs / 1000);
  return times.length === 0 ? undefined : Math.max(...times);
}

export function framesSkipped({ frames }: ConsoleState): number {
  return [...frames.values()].reduce((sum, { skipped }) => sum + Number(skipped), 0);
}

interface ServicesHealth {
  /** Number of healthy services. */
  readonly ok: number;
  /** The others. */
  readonly ill: readonly Service[];
}

export function healthOf(services: Iterable<Service>): ServicesHealth {
  const all = [...services];
  const ill = all.filter(({ level }) => level !== Level.OK);
  return { ok: all.length - ill.length, ill };
}

/** `level`: undefined = no link. */
export function levelText(level: Level | undefined): string {
  switch (level) {
    case undefined:
      return "◌ unknown";
    case Level.OK:
      return "● ok";
    case Level.WARNING:
      return "◆ warning";
    case Level.ERROR:
      return "▲ error";
    default:
      return "○ silent";
  }
}

export function levelClass(level: Level | undefined): string {
  if (level === undefined) return "quiet";
  if (level === Level.OK) return "good";
  return level === Level.WARNING ? "warn" : "bad";
}

/** Amber and red above the limits of driving by hand. */
export function roundTripClass(
  roundTrip: number | undefined,
  limits: { advisedAgainst: number; refused: number },
): string {
  if (roundTrip === undefined) return "quiet";
  if (roundTrip > limits.refused) return "bad";
  return roundTrip > limits.advisedAgainst ? "warn" : "good";
}
