import { expect, it } from "vitest";
import { whiteCells } from "./page_tags";

it("the first cell of a tag is the highest of 36 bits, cells go by rows", () => {
  expect(whiteCells(1n << 35n)).toBe("M2 2h1v1h-1z");
  expect(whiteCells(1n << 34n)).toBe("M3 2h1v1h-1z");
  expect(whiteCells(1n << 29n)).toBe("M2 3h1v1h-1z");
  expect(whiteCells(1n)).toBe("M7 7h1v1h-1z");
  expect(whiteCells(0n)).toBe("");
});
