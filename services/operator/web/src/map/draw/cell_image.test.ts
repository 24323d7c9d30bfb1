import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { CellImage, type CellLook } from "./cell_image";
import { RecordingContext } from "./recording";

const size = { rows: 100, columns: 50 };
const view = { scale: 10, x: 20, y: 30, width: 800, height: 600 };

/** Rows that were painted, as [first, number]. */
let painted: [number, number][];

beforeEach(() => {
  painted = [];
  const context = {
    createImageData: (columns: number, rows: number) => ({
      data: new Uint8ClampedArray(4 * columns * rows),
      height: rows,
    }),
    putImageData: (data: { height: number }, _: number, row: number) => {
      painted.push([row, data.height]);
    },
    drawImage: () => undefined,
  };
  const canvas = () => ({ width: 0, height: 0, getContext: () => context });
  vi.stubGlobal("document", { createElement: canvas });
  vi.stubGlobal("devicePixelRatio", 1);
});
afterEach(() => vi.unstubAllGlobals());

function look(grid: Uint8Array, key = "light"): CellLook {
  return { grids: [grid], keys: [key], pixelAt: (index) => grid[index] ?? 0 };
}

function drawn(image: CellImage, what: CellLook, at = view): RecordingContext {
  const onto = new RecordingContext();
  image.draw(onto, at, size, what, 1);
  return onto;
}

describe("an image of cells", () => {
  it("is painted once, then where cells change, and everywhere when its colours do", () => {
    const image = new CellImage();
    const grid = new Uint8Array(5000);
    drawn(image, look(grid));
    drawn(image, look(grid), { ...view, x: 0 });
    expect(painted).toEqual([[0, 100]]);
    const changed = grid.slice();
    changed[35 * 50 + 7] = 1;
    drawn(image, look(changed));
    expect(painted.slice(1)).toEqual([[32, 16]]);
    drawn(image, look(changed, "dark"));
    expect(painted.slice(2)).toEqual([[0, 100]]);
  });

  it("is put where its cells are, crisp; only what is in sight", () => {
    const all = drawn(new CellImage(), look(new Uint8Array(5000)));
    expect(all.named("drawImage")[0]?.values.slice(1)).toEqual([0, 0, 50, 58, 20, 30, 500, 580]);
    expect(all.imageSmoothingEnabled).toBe(false);
    const moved = drawn(new CellImage(), look(new Uint8Array(5000)), { ...view, x: -95, y: 0 });
    expect(moved.named("drawImage")[0]?.values.slice(1)).toEqual([9, 0, 41, 61, -5, 0, 410, 610]);
    const away = drawn(new CellImage(), look(new Uint8Array(5000)), { ...view, x: 900 });
    expect(away.named("drawImage")).toEqual([]);
  });

  it("is averaged from a smaller image where several cells share a pixel", () => {
    const far = drawn(new CellImage(), look(new Uint8Array(5000)), { ...view, scale: 0.2 });
    const [image, ...place] = far.named("drawImage")[0]?.values ?? [];
    expect(image).toMatchObject({ width: 13, height: 25 });
    expect(place.map(Number)).toEqual([0, 0, 13, 25, 20, 30, 13 * 0.8, 25 * 0.8]);
    expect(far.imageSmoothingEnabled).toBe(true);
  });
});
