import type { Attention } from "../../protocol/generated/console_pb";

/** Workload over time, as columns of equal length; undefined = not measured. */
export interface History {
  /** s, operator's time. */
  readonly time: readonly number[];
  readonly utilisation: readonly (number | undefined)[];
  readonly fanOut: readonly (number | undefined)[];
  readonly waiting: readonly number[];
}

export const emptyHistory: History = { time: [], utilisation: [], fanOut: [], waiting: [] };

/** s between two samples, and the number of samples kept. */
const period = 1;
export const mostSamples = 900;

/** Returns the same object if `attention` brings no new sample. When time runs backwards, as in a recording, starts over. */
export function withSample(history: History, attention: Attention): History {
  const newest = history.time.at(-1);
  const { stamp, utilisation, attendedRobots, observed, items } = attention;
  if (newest !== undefined && stamp < newest) return withSample(emptyHistory, attention);
  if (newest !== undefined && stamp - newest < period) return history;
  const measured = (value: number) => (observed > 0 ? value : undefined);
  return {
    time: newestOf(history.time, stamp),
    utilisation: newestOf(history.utilisation, measured(utilisation)),
    fanOut: newestOf(history.fanOut, measured(attendedRobots)),
    waiting: newestOf(history.waiting, items.filter(({ selectedBy }) => selectedBy === "").length),
  };
}

function newestOf<T>(values: readonly T[], value: T): readonly T[] {
  return [...values.slice(1 - mostSamples), value];
}

/** Above 70 % waiting times grow quickly (Donmez, Nehme and Cummings 2010). */
export function loadLevel(utilisation: number): "calm" | "busy" | "overloaded" {
  if (utilisation > 0.85) return "overloaded";
  return utilisation > 0.7 ? "busy" : "calm";
}
