/** First of the `size` of `length` entries to show, so that number `at` is about in the middle; the newest where there is none. */
export function windowStart(length: number, at: number, size: number): number {
  const newest = Math.max(0, length - size);
  return at < 0 ? newest : Math.max(0, Math.min(newest, at - Math.floor(size / 2)));
}
