import { allRows, type Band, changedBands, joined } from "../bands";
import type { GridSize } from "../grid";
import { cellCorner, type View, visibleRange } from "../view";
import { type Draw, isolated } from "./context";
import { sameValues } from "./offscreen";
import type { Pixel } from "./pixels";

/** What a layer shows of each cell, as one pixel. */
export type CellLook = {
  /** The grids that the pixels follow from, compared by identity, then band by band. */
  readonly grids: readonly Uint8Array[];
  /** Whatever else they follow from, compared by identity. */
  readonly keys: readonly unknown[];
  readonly pixelAt: (index: number) => Pixel;
};

/**
 * A layer of cells as an image of one pixel per cell. It is painted where its grids change, and scaled onto each frame: crisp
 * when cells are larger than pixels, averaged when they are smaller.
 */
export class CellImage {
  /** The image, half of it, a quarter, ... as far as they were needed. */
  #levels: HTMLCanvasElement[] = [];
  #size: GridSize = { rows: 0, columns: 0 };
  #look: CellLook | undefined;

  draw(onto: Draw, view: View, size: GridSize, look: CellLook, strength: number): void {
    if (strength <= 0) return;
    this.#update(size, look);
    const perCell = view.scale * devicePixelRatio;
    const level = this.#levelFor(perCell);
    const image = this.#levels[level];
    if (!image) return;
    isolated(onto, () => {
      onto.imageSmoothingEnabled = perCell < 1;
      onto.globalAlpha = strength;
      drawVisible(onto, view, size, image, 2 ** level);
    });
  }

  #update(size: GridSize, look: CellLook): void {
    const bands = this.#outdated(size, look);
    this.#look = look;
    if (bands.length === 0) return;
    if (size.rows !== this.#size.rows || size.columns !== this.#size.columns) this.#levels = [];
    this.#size = { rows: size.rows, columns: size.columns };
    const image = this.#levels[0] ?? emptyImage(size);
    const context = image.getContext("2d");
    this.#levels = context ? [image] : [];
    if (context) for (const band of bands) paint(context, size, look, band);
  }

  #outdated(size: GridSize, look: CellLook): Band[] {
    const before = this.#look;
    const same =
      before?.grids.length === look.grids.length &&
      sameValues(before.keys, look.keys) &&
      size.rows === this.#size.rows &&
      size.columns === this.#size.columns;
    if (!same) return allRows(size);
    return joined(
      look.grids.flatMap((grid, i) => changedBands(size, before.grids[i] ?? grid, grid)),
    );
  }

  /** The smallest image that has a pixel for each of the screen's. Makes those up to it. */
  #levelFor(perCell: number): number {
    const [first] = this.#levels;
    if (!first) return 0;
    const level = Math.max(0, Math.floor(-Math.log2(perCell)));
    for (let last = first; this.#levels.length <= level; ) {
      last = halved(last);
      this.#levels.push(last);
    }
    return level;
  }
}

/** `factor`: cells per pixel of the image. Leaves out what is not in sight, as far away coordinates lose precision. */
function drawVisible(
  onto: Draw,
  view: View,
  size: GridSize,
  image: HTMLCanvasElement,
  factor: number,
): void {
  const { top, left, bottom, right } = visibleRange(view, size);
  if (bottom < top || right < left) return;
  const x = Math.floor(left / factor);
  const y = Math.floor(top / factor);
  const width = Math.min(image.width, Math.floor(right / factor) + 1) - x;
  const height = Math.min(image.height, Math.floor(bottom / factor) + 1) - y;
  const corner = cellCorner(view, { row: y * factor, column: x * factor });
  const scale = view.scale * factor;
  onto.drawImage(image, x, y, width, height, corner.x, corner.y, width * scale, height * scale);
}

function emptyImage(size: GridSize): HTMLCanvasElement {
  const image = document.createElement("canvas");
  image.width = size.columns;
  image.height = size.rows;
  return image;
}

function paint(
  context: CanvasRenderingContext2D,
  { columns }: GridSize,
  { pixelAt }: CellLook,
  { begin, end }: Band,
): void {
  const data = context.createImageData(columns, end - begin);
  const pixels = new Uint32Array(data.data.buffer);
  const first = begin * columns;
  for (let i = 0; i < pixels.length; ++i) pixels[i] = pixelAt(first + i);
  context.putImageData(data, 0, begin);
}

/** Half as wide and high: each pixel is the mean of four. */
function halved(image: HTMLCanvasElement): HTMLCanvasElement {
  const half = emptyImage({
    rows: Math.ceil(image.height / 2),
    columns: Math.ceil(image.width / 2),
  });
  half.getContext("2d")?.drawImage(image, 0, 0, image.width / 2, image.height / 2);
  return half;
}
