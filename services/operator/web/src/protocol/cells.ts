/** A cell, such as the protocol's Cell. Row 0 is the northern row, column 0 the western. */
export interface CellAt {
  readonly row: number;
  readonly column: number;
}

export interface GridSize {
  readonly rows: number;
  readonly columns: number;
}

/** Cells of a message: cell i is (row[i], column[i]). */
export function cellsOf(
  cells: { readonly row: readonly number[]; readonly column: readonly number[] } | undefined,
): CellAt[] {
  if (cells === undefined) return [];
  return cells.row.map((row, i) => ({ row, column: cells.column[i] ?? 0 }));
}

/** Row-major, as all grids of the protocol are. */
export function cellIndex({ columns }: Pick<GridSize, "columns">, cell: CellAt): number {
  return cell.row * columns + cell.column;
}

export function sameCell(a: CellAt | undefined, b: CellAt | undefined): boolean {
  return a !== undefined && b !== undefined && a.row === b.row && a.column === b.column;
}

/** A cell as people read it. */
export function cellText(cell: CellAt | undefined): string {
  return cell === undefined ? "–" : `row ${cell.row}, column ${cell.column}`;
}

/** Whether a cell of a Belief counts as a wall. There are no walls outside the grid. */
export function isWallAt(walls: Uint8Array, index: number): boolean {
  return (walls[index] ?? 0) >= 128;
}
