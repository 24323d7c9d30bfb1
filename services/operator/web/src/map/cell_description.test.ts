import { create } from "@bufbuild/protobuf";
import { expect, it } from "vitest";
import { SeenMapSchema } from "../protocol/generated/console_pb";
import { describeCell } from "./cell_description";

const at = (row: number, column: number) => ({ row, column });
const facts = {
  size: { rows: 1, columns: 3 },
  walls: Uint8Array.of(0, 200, 0),
  seen: new Map([
    ["r1", create(SeenMapSchema, { cells: Uint8Array.of(1, 2, 0) })],
    ["r2", create(SeenMapSchema, { cells: Uint8Array.of(0, 1, 0) })],
  ]),
  robots: [{ name: "r1", cell: at(0, 0), goalsLeft: [at(0, 2)] }],
};

it("says what the map has, who saw what, and what is there", () => {
  expect(describeCell(at(0, 0), facts)).toBe(
    "Row 0, column 0: free on your map; r1 saw it free; r1 is here.",
  );
  expect(describeCell(at(0, 1), facts)).toBe(
    "Row 0, column 1: wall on your map; r1 saw a wall; r2 saw it free.",
  );
  expect(describeCell(at(0, 2), facts)).toBe(
    "Row 0, column 2: free on your map; no robot saw it; a goal of r1.",
  );
});

it("says when there is no map yet", () => {
  expect(describeCell(at(0, 0), { ...facts, walls: undefined })).toContain("has not come yet");
});

it("says nothing of what robots saw where nobody is told", () => {
  const told = { ...facts, seen: new Map() };
  expect(describeCell(at(0, 0), told)).toBe("Row 0, column 0: free on your map; r1 is here.");
});
