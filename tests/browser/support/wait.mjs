import { setTimeout as pause } from "node:timers/promises";

/** s to wait for a condition on a busy machine. */
export const patience = 20;

/**
 * Calls `look` until it returns something other than false and undefined, and returns that. On timeout the error names `what` was
 * awaited, and `now`, if given, the current value.
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

/** Checks that a condition holds all the time. */
export async function stays(what, seconds, look) {
  const end = Date.now() + 1000 * seconds;
  while (Date.now() < end) {
    if (!(await look())) throw new Error(`not for ${seconds} s: ${what}`);
    await pause(50);
  }
}

/** Waits until a value stays the same for some seconds. */
export async function settles(what, seconds, look) {
  let [last, since] = [look(), Date.now()];
  await until(what, () => {
    const now = look();
    if (now !== last) [last, since] = [now, Date.now()];
    return Date.now() > since + 1000 * seconds;
  });
}

function instead(now) {
  return now === undefined ? "" : `; instead: ${JSON.stringify(now(), printable)}`;
}

/** @param {string} _ @param {unknown} value */
export function printable(_, value) {
  if (typeof value === "bigint") return Number(value);
  return value instanceof Uint8Array ? `${value.length} bytes` : value;
}
