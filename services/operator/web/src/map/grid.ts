// Cells and grids. Row 0 is the northern row, column 0 the western; cells in row-major order.

import { type CellAt as Cell, cellIndex, type GridSize, isWallAt } from "../protocol/cells";

export {
  type CellAt as Cell,
  cellIndex,
  cellText,
  type GridSize,
  isWallAt,
  sameCell,
} from "../protocol/cells";

/** Values of SeenMap.cells and Truth.cells. */
export const unknownCell = 0;
export const freeCell = 1;
export const wallCell = 2;

export function contains(size: GridSize, cell: Cell): boolean {
  return cell.row >= 0 && cell.row < size.rows && cell.column >= 0 && cell.column < size.columns;
}

/** Border cells are always walls: the service refuses to edit them. */
export function onBorder(size: GridSize, cell: Cell): boolean {
  return (
    cell.row === 0 ||
    cell.column === 0 ||
    cell.row === size.rows - 1 ||
    cell.column === size.columns - 1
  );
}

export function cellOfIndex(size: GridSize, index: number): Cell {
  return { row: Math.floor(index / size.columns), column: index % size.columns };
}

export function clampCell(size: GridSize, cell: Cell): Cell {
  return {
    row: Math.min(size.rows - 1, Math.max(0, cell.row)),
    column: Math.min(size.columns - 1, Math.max(0, cell.column)),
  };
}

export function distance(a: Cell, b: Cell): number {
  return Math.abs(a.row - b.row) + Math.abs(a.column - b.column);
}

export function isWall(walls: Uint8Array, size: GridSize, cell: Cell): boolean {
  return contains(size, cell) && isWallAt(walls, cellIndex(size, cell));
}

/** All cells of the rectangle with these corners. */
export function rectangleCells(a: Cell, b: Cell): Cell[] {
  const cells: Cell[] = [];
  for (let row = Math.min(a.row, b.row); row <= Math.max(a.row, b.row); ++row) {
    for (
      let column = Math.min(a.column, b.column);
      column <= Math.max(a.column, b.column);
      ++column
    ) {
      cells.push({ row, column });
    }
  }
  return cells;
}

/** The straight line from one cell to another in steps to 4-neighbours, both ends included: the cells under a brush. */
export function lineCells(from: Cell, to: Cell): Cell[] {
  const rows = Math.abs(to.row - from.row);
  const columns = Math.abs(to.column - from.column);
  const down = Math.sign(to.row - from.row);
  const right = Math.sign(to.column - from.column);
  const cells: Cell[] = [{ row: from.row, column: from.column }];
  for (let y = 0, x = 0; y < rows || x < columns; ) {
    if ((2 * x + 1) * rows < (2 * y + 1) * columns) ++x;
    else ++y;
    cells.push({ row: from.row + y * down, column: from.column + x * right });
  }
  return cells;
}
