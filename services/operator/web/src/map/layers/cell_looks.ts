// The layers of cells as images of one pixel per cell. Those of belief and fog are shown at every zoom, the others while
// cells are too small for marks.

import type { Prediction } from "../../protocol/generated/console_pb";
import type { CellLook } from "../draw/cell_image";
import type { Palette } from "../draw/palette";
import { over, type Pixel, pixelOf, transparent } from "../draw/pixels";
import { freeCell, type GridSize, isWallAt, unknownCell, wallCell } from "../grid";

/** The operator's map. More certain walls are darker. Border cells have their own colour. */
export function beliefLook(size: GridSize, walls: Uint8Array, palette: Palette): CellLook {
  const { rows, columns } = size;
  const free = pixelOf(palette.free);
  const shades = (colour: string) =>
    Uint32Array.from({ length: 256 }, (_, value) => over(free, pixelOf(colour), value / 255));
  const inside = shades(palette.wall);
  const border = shades(palette.border);
  const pixelAt = (index: number): Pixel => {
    const column = index % columns;
    const onBorder =
      index < columns || index >= (rows - 1) * columns || column === 0 || column === columns - 1;
    return (onBorder ? border : inside)[walls[index] ?? 0] ?? free;
  };
  return { grids: [walls], keys: [palette], pixelAt };
}

/** A veil over the cells that no robot has seen. */
export function fogLook(seen: Uint8Array, palette: Palette): CellLook {
  const fog = pixelOf(palette.fog);
  const pixelAt = (index: number) => (seen[index] === unknownCell ? fog : transparent);
  return { grids: [seen], keys: [palette], pixelAt };
}

/** The operator's changes since the initial map. */
export function changesLook(walls: Uint8Array, initial: Uint8Array, palette: Palette): CellLook {
  const changed = over(transparent, pixelOf(palette.changed), 0.6);
  const pixelAt = (index: number) =>
    isWallAt(walls, index) === isWallAt(initial, index) ? transparent : changed;
  return { grids: [walls, initial], keys: [palette], pixelAt };
}

/** Where the operator's map differs from what robots saw. */
export function differencesLook(walls: Uint8Array, seen: Uint8Array, palette: Palette): CellLook {
  const differs = pixelOf(palette.differs);
  const pixelAt = (index: number) => {
    const known = isWallAt(walls, index) ? freeCell : wallCell;
    return seen[index] === known ? differs : transparent;
  };
  return { grids: [walls, seen], keys: [palette], pixelAt };
}

/** Where the operator's map is wrong. */
export function truthLook(walls: Uint8Array, truth: Uint8Array, palette: Palette): CellLook {
  const colour = pixelOf(palette.truth);
  const pixelAt = (index: number) =>
    (truth[index] === wallCell) === isWallAt(walls, index) ? transparent : colour;
  return { grids: [walls, truth], keys: [palette], pixelAt };
}

export const leastHeat = 10; // of 255

/** Opacity of an edit that the model expects with `value` of 255. */
export function heatStrength(value: number): number {
  return value < leastHeat ? 0 : 0.12 + 0.5 * (value / 255);
}

/** Edits that the model expects from the operator. */
export function heatLook(predictions: readonly Prediction[], palette: Palette): CellLook {
  const add = pixelOf(palette.add);
  const remove = pixelOf(palette.remove);
  const pixelAt = (index: number) => {
    let shown = transparent;
    for (const prediction of predictions) {
      const added = heatStrength(prediction.add[index] ?? 0);
      const removed = heatStrength(prediction.remove[index] ?? 0);
      if (added > 0) shown = over(shown, add, added);
      if (removed > 0) shown = over(shown, remove, removed);
    }
    return shown;
  };
  const grids = predictions.flatMap((prediction) => [prediction.add, prediction.remove]);
  return { grids, keys: [palette], pixelAt };
}
