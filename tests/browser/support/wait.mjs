import { setTimeout as pause } from "node:timers/promises";

/** s that a condition may take on a busy machine. */
export const patience = 20;

/**
 * Looks again and again until `look` returns something that is neither false nor undefined, and returns that.
 * `what` says in words what was waited for; `now`, if given, tells what there was instead.
 * @template T
 * @param {string} what
 * @param {() => T | Promise<T>} look
 * @param {{ within?: number, every?: number, now?: () => unknown }} [options] times in s
 * @returns {Promise<Exclude<T, false | undefined>>}
 */
export async function until(what, look, { within = patience, every = 0.05, now } = {}) {
  const end = Date.now() + 1000 * within;
  for (;;) {
    const found = await look();
    if (found !== false && found !== undefined) return found;
    if (Date.now() > end) throw new Error(`not within ${within} s: ${what}${instead(now)}`);
    await pause(1000 * every);
  }
}

/** For what must not happen: true all the time. */
export async function stays(what, seconds, look) {
  const end = Date.now() + 1000 * seconds;
  while (Date.now() < end) {
    if (!(await look())) throw new Error(`not for ${seconds} s: ${what}`);
    await pause(50);
  }
}

function instead(now) {
  return now === undefined ? "" : `; instead: ${JSON.stringify(now(), printable)}`;
}

/** @param {string} _ @param {unknown} value */
export function printable(_, value) {
  if (typeof value === "bigint") return Number(value);
  return value instanceof Uint8Array ? `${value.length} bytes` : value;
}
