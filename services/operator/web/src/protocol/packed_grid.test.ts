import { create, type MessageInitShape, toBinary } from "@bufbuild/protobuf";
import fc from "fast-check";
import { describe, expect, it } from "vitest";
import { decode } from "./codec";
import { ServerMessageSchema, type UpdateSchema } from "./generated/console_pb";
import { unpackGrid } from "./packed_grid";

function varint(number: number): number[] {
  return number < 128 ? [number] : [128 + (number % 128), ...varint(Math.floor(number / 128))];
}

/** As the service does it, in short runs now and then. */
function packed(cells: readonly number[], columns: number, longest = 1e9): Uint8Array<ArrayBuffer> {
  const bytes = varint(columns);
  const differences = cells.map((cell, i) => cell ^ (cells[i - columns] ?? 0));
  for (let begin = 0; begin < cells.length; ) {
    let end = begin + 1;
    while (end - begin < longest && differences[end] === differences[begin]) end += 1;
    bytes.push(...varint(end - begin), differences[begin] ?? 0);
    begin = end;
  }
  return Uint8Array.from(bytes);
}

describe("a packed grid", () => {
  it("gives back every cell, whatever the runs", () => {
    const cells = fc.array(fc.constantFrom(0, 0, 0, 1, 255), { maxLength: 300 });
    fc.assert(
      fc.property(cells, fc.integer({ min: 1, max: 50 }), fc.nat(40), (all, columns, most) => {
        expect([...unpackGrid(packed(all, columns, most + 1))]).toEqual(all);
      }),
    );
  });

  it("of three columns, two rows alike and one of walls", () => {
    const bytes = Uint8Array.from([3, 1, 1, 2, 2, 3, 0, 1, 3, 2, 0]);
    expect([...unpackGrid(bytes)]).toEqual([1, 2, 2, 1, 2, 2, 2, 2, 2]);
  });

  it("is refused when it is cut off or would be enormous", () => {
    expect(() => unpackGrid(Uint8Array.from([3, 9]))).toThrow(RangeError);
    expect(() => unpackGrid(Uint8Array.from([3, 255, 255, 255, 255, 15, 0]))).toThrow(RangeError);
    expect(unpackGrid(new Uint8Array())).toEqual(new Uint8Array());
  });

  it("is unpacked in every message that has one; a message with a damaged one is none", () => {
    const grid = packed([1, 2], 2);
    const received = (cells: Uint8Array<ArrayBuffer>) => {
      const update: MessageInitShape<typeof UpdateSchema>[] = [
        { body: { case: "belief", value: { walls: cells, initialWalls: cells } } },
        { body: { case: "seen", value: { cells } } },
        { body: { case: "truth", value: { cells } } },
        { body: { case: "prediction", value: { add: cells, remove: cells } } },
      ];
      const body = { case: "updates", value: { update } } as const;
      const bytes = toBinary(ServerMessageSchema, create(ServerMessageSchema, { body }));
      return decode(new Uint8Array(bytes).buffer)?.body;
    };
    const cells = Uint8Array.from([1, 2]);
    expect(received(grid)).toMatchObject({
      value: {
        update: [
          { body: { value: { walls: cells, initialWalls: cells } } },
          { body: { value: { cells } } },
          { body: { value: { cells } } },
          { body: { value: { add: cells, remove: cells } } },
        ],
      },
    });
    expect(received(Uint8Array.from([2, 5]))).toBeUndefined();
  });
});
