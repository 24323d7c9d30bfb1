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

it("says what the map has, which robots saw what, and what is there", () => {
  expect(describeCell(at(0, 0), facts)).toMatch(
    /^Row 0, column 0: free on .*; r1 saw .* free; r1 .*\.$/,
  );
  expect(describeCell(at(0, 1), facts)).toMatch(/: wall on .*; r1 saw a wall; r2 saw .* free\.$/);
  expect(describeCell(at(0, 2), facts)).toMatch(/: free on .*; not seen .*; goal of r1\.$/);
});

it("says neither wall nor free while there is no map", () => {
  const text = describeCell(at(0, 0), { ...facts, walls: undefined, seen: new Map() });
  expect(text).not.toMatch(/wall|free/);
});

it("leaves out what robots saw where it is secret", () => {
  expect(describeCell(at(0, 0), { ...facts, seen: new Map() })).not.toContain("saw");
});
