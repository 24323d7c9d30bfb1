import { effect, signal } from "@preact/signals";
import { expect, it } from "vitest";
import { sameText } from "./same_text";

it("changes only when what it tells does", () => {
  const source = signal({ row: 1, doing: "stands" });
  const told = sameText(() => ({ doing: source.value.doing }));
  const seen: unknown[] = [];
  effect(() => {
    seen.push(told.value);
  });
  source.value = { row: 2, doing: "stands" };
  expect(seen).toEqual([{ doing: "stands" }]);
  source.value = { row: 2, doing: "met a wall" };
  expect(seen).toEqual([{ doing: "stands" }, { doing: "met a wall" }]);
});
