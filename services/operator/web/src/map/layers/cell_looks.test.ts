import { create } from "@bufbuild/protobuf";
import { afterAll, beforeAll, describe, expect, it, vi } from "vitest";
import { PredictionSchema } from "../../protocol/generated/console_pb";
import type { CellLook } from "../draw/cell_image";
import { colourNames, paletteFrom } from "../draw/palette";
import { transparent } from "../draw/pixels";
import {
  beliefLook,
  changesLook,
  differencesLook,
  fogLook,
  heatLook,
  truthLook,
} from "./cell_looks";

const size = { rows: 4, columns: 4 };
const palette = paletteFrom((name) => name);

/** Each colour's red says which it is; blue and green are 0. */
const redOf = (name: (typeof colourNames)[number]) => colourNames.indexOf(name) + 1;

beforeAll(() => {
  const names: readonly string[] = colourNames;
  const context = {
    fillStyle: "",
    fillRect: () => undefined,
    getImageData: () => ({ data: [1 + names.indexOf(context.fillStyle), 0, 0, 255] }),
  };
  vi.stubGlobal("document", { createElement: () => ({ getContext: () => context }) });
});
afterAll(() => vi.unstubAllGlobals());

function grid(values: Record<number, number>): Uint8Array<ArrayBuffer> {
  const cells = new Uint8Array(size.rows * size.columns);
  for (const [index, value] of Object.entries(values)) cells[Number(index)] = value;
  return cells;
}

/** The cells that are not transparent. */
const shown = ({ pixelAt }: CellLook) =>
  [...grid({}).keys()].filter((index) => pixelAt(index) !== transparent);
const red = ({ pixelAt }: CellLook, index: number) => pixelAt(index) & 255;

describe("the operator's map", () => {
  it("is free, wall, or in between where it is not sure; the border has a colour of its own", () => {
    const look = beliefLook(size, grid({ 0: 255, 5: 255, 6: 128 }), palette);
    expect([0, 5, 9].map((index) => red(look, index))).toEqual([
      redOf("border"),
      redOf("wall"),
      redOf("free"),
    ]);
    expect(beliefLook(size, grid({ 5: 0, 6: 255 }), { ...palette, free: "paper" }).pixelAt(5)).toBe(
      (0xff000000 | redOf("paper")) >>> 0,
    );
    expect(red(look, 6)).toBe(Math.round((redOf("wall") + redOf("free")) / 2));
  });
});

describe("small cells are coloured", () => {
  const walls = grid({ 5: 255, 6: 255 });

  it("where no robot has been", () => {
    expect(shown(fogLook(grid({ 5: 1, 6: 2 }), palette))).toHaveLength(14);
  });

  it("where the operator changed the map", () => {
    expect(shown(changesLook(walls, grid({ 6: 255, 9: 255 }), palette))).toEqual([5, 9]);
  });

  it("where robots saw something else", () => {
    expect(shown(differencesLook(walls, grid({ 5: 1, 6: 2, 9: 1, 10: 2 }), palette))).toEqual([
      5, 10,
    ]);
  });

  it("where the map is wrong", () => {
    expect(shown(truthLook(walls, grid({ 6: 2, 9: 2 }), palette))).toEqual([5, 9]);
  });

  it("where the model expects an edit, the more the likelier, with all robots' added up", () => {
    const one = create(PredictionSchema, { add: grid({ 5: 255, 6: 100, 7: 9 }), remove: grid({}) });
    const look = heatLook([one], palette);
    expect(shown(look)).toEqual([5, 6]);
    const alpha = ({ pixelAt }: CellLook, index: number) => pixelAt(index) >>> 24;
    expect(alpha(look, 5)).toBeGreaterThan(alpha(look, 6));
    expect(alpha(heatLook([one, one], palette), 6)).toBeGreaterThan(alpha(look, 6));
  });
});
