import { expect, it } from "vitest";
import { windowStart } from "./history_strip";

it.each([
  [3, 1, 12, 0],
  [30, -1, 12, 18],
  [30, 29, 12, 18],
  [30, 15, 12, 9],
  [30, 2, 12, 0],
])("of %i entries, with number %i chosen, %i are shown from %i on", (length, at, size, first) => {
  expect(windowStart(length, at, size)).toBe(first);
});
