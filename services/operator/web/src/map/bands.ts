// Large grids are compared and repainted band by band, so that a change costs what changed.
import type { GridSize } from "./grid";

/** Rows of a grid, all columns; `end` is not included. */
export type Band = { readonly begin: number; readonly end: number };

/** Rows of a band. */
const height = 16;

export function allRows(size: GridSize): Band[] {
  return size.rows > 0 ? [{ begin: 0, end: size.rows }] : [];
}

/** The bands in which the cells differ; all rows if `before` is of another size. Neighbouring bands are one. */
export function changedBands(size: GridSize, before: Uint8Array, after: Uint8Array): Band[] {
  if (before === after) return [];
  if (before.length !== after.length) return allRows(size);
  const bands: Band[] = [];
  for (let begin = 0; begin < size.rows; begin += height) {
    const end = Math.min(size.rows, begin + height);
    if (!sameBytes(before, after, begin * size.columns, end * size.columns)) {
      bands.push({ begin, end });
    }
  }
  return joined(bands);
}

/** Neighbouring and overlapping bands as one, in order. */
export function joined(bands: readonly Band[]): Band[] {
  const all: Band[] = [];
  for (const band of [...bands].sort((a, b) => a.begin - b.begin)) {
    const last = all.at(-1);
    if (!last || last.end < band.begin) all.push(band);
    else all[all.length - 1] = { begin: last.begin, end: Math.max(last.end, band.end) };
  }
  return all;
}

function sameBytes(a: Uint8Array, b: Uint8Array, begin: number, end: number): boolean {
  for (let i = begin; i < end; ++i) {
    if (a[i] !== b[i]) return false;
  }
  return true;
}
