import type { SeenMap } from "../protocol/generated/console_pb";
import { allRows, type Band, changedBands, joined } from "./bands";
import { cellOfIndex, freeCell, type GridSize, isWallAt, onBorder, unknownCell } from "./grid";
import type { CellChange } from "./map_props";

/** What all robots have seen together, put together again only where a robot has seen more. */
export class SeenTogether {
  #size: GridSize = { rows: 0, columns: 0 };
  #maps: readonly Uint8Array[] = [];
  #cells = new Uint8Array();

  /** If two maps disagree, the later wins. The same array while nothing changes. */
  cells(size: GridSize, maps: readonly SeenMap[]): Uint8Array {
    const now = maps.map((map) => map.cells);
    const bands = this.#outdated(size, now);
    if (bands.length === 0) return this.#cells;
    const count = size.rows * size.columns;
    const all = this.#cells.length === count ? this.#cells.slice() : new Uint8Array(count);
    for (const { begin, end } of bands) {
      all.fill(unknownCell, begin * size.columns, end * size.columns);
      for (const map of now) copySeen(map, all, begin * size.columns, end * size.columns);
    }
    this.#size = { rows: size.rows, columns: size.columns };
    this.#maps = now;
    this.#cells = all;
    return all;
  }

  #outdated(size: GridSize, maps: readonly Uint8Array[]): Band[] {
    const same =
      maps.length === this.#maps.length &&
      size.rows === this.#size.rows &&
      size.columns === this.#size.columns;
    if (!same) return allRows(size);
    return joined(maps.flatMap((map, i) => changedBands(size, this.#maps[i] ?? map, map)));
  }
}

/** Walls for routes: those of the operator's map, except where robots saw something else. */
export function wallsKnown(walls: Uint8Array, seen: Uint8Array): Uint8Array {
  return walls.map((wall, index) => {
    const value = seen[index] ?? unknownCell;
    if (value === unknownCell) return wall;
    return value === freeCell ? 0 : 255;
  });
}

/** What would make the operator's map agree with what robots saw. Borders stay. */
export function differencesOf(walls: Uint8Array, seen: Uint8Array, size: GridSize): CellChange[] {
  const changes: CellChange[] = [];
  seen.forEach((value, index) => {
    if (value === unknownCell || (value === freeCell) !== isWallAt(walls, index)) return;
    const cell = cellOfIndex(size, index);
    if (!onBorder(size, cell)) changes.push({ cell, wall: value !== freeCell });
  });
  return changes;
}

/** The same function, which works only when one of the maps is another array: maps have a million cells. */
export function keptFor<T>(
  workOut: (walls: Uint8Array, seen: Uint8Array, size: GridSize) => T,
): typeof workOut {
  let kept: { walls: Uint8Array; seen: Uint8Array; value: T } | undefined;
  return (walls, seen, size) => {
    if (kept?.walls !== walls || kept.seen !== seen) {
      kept = { walls, seen, value: workOut(walls, seen, size) };
    }
    return kept.value;
  };
}

function copySeen(from: Uint8Array, to: Uint8Array, begin: number, end: number): void {
  for (let i = begin; i < end; ++i) {
    const value = from[i] ?? unknownCell;
    if (value !== unknownCell) to[i] = value;
  }
}
