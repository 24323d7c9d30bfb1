import { create } from "@bufbuild/protobuf";
import fc from "fast-check";
import { expect, it } from "vitest";
import { SeenMapSchema } from "../protocol/generated/console_pb";
import { unknownCell } from "./grid";
import { SeenTogether } from "./seen_together";

const size = { rows: 40, columns: 5 };
const seenMap = (cells: Uint8Array<ArrayBuffer>) => create(SeenMapSchema, { cells });

/** Cell by cell; the last map that knows one decides. */
function expected(maps: readonly Uint8Array[]): number[] {
  return Array.from(
    { length: size.rows * size.columns },
    (_, i) =>
      maps.findLast((cells) => (cells[i] ?? unknownCell) !== unknownCell)?.[i] ?? unknownCell,
  );
}

it("is what all maps together show, whatever changes in whichever of them", () => {
  const change = fc.record({ robot: fc.nat(2), index: fc.nat(199), value: fc.nat(2) });
  fc.assert(
    fc.property(fc.array(change, { maxLength: 12 }), (changes) => {
      const together = new SeenTogether();
      const maps = [0, 1, 2].map(() => new Uint8Array(size.rows * size.columns));
      for (const { robot, index, value } of changes) {
        const cells = maps[robot]?.slice() ?? new Uint8Array();
        cells[index] = value;
        maps[robot] = cells;
        const shown = together.cells(size, maps.map(seenMap));
        expect([...shown]).toEqual(expected(maps));
      }
    }),
  );
});

it("is the same array until something changes, and follows robots that come and go", () => {
  const together = new SeenTogether();
  const one = seenMap(Uint8Array.from({ length: 200 }, () => 1));
  const two = seenMap(Uint8Array.from({ length: 200 }, () => 2));
  const before = together.cells(size, [one]);
  expect(together.cells(size, [one])).toBe(before);
  expect(together.cells(size, [one, two])[7]).toBe(2);
  expect(together.cells(size, [one])[7]).toBe(1);
  expect(together.cells(size, [])[7]).toBe(unknownCell);
});
