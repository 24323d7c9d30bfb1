const shortestWait = 0.25;
const longestWait = 4;

/** How long to wait before attempt 1, 2, ..., s: doubled each time, and half of it by chance, so that not all pages come back at once. */
export function backoff(attempt: number, random: number): number {
  const full = Math.min(longestWait, shortestWait * 2 ** Math.max(0, attempt));
  return Math.max(shortestWait, full * (0.5 + random / 2));
}
