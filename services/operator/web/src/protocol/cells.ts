/** Row 0 is the northern row, column 0 the western. */
export interface CellAt {
  readonly row: number;
  readonly column: number;
}

/** Of a message that tells many: cell i is (row[i], column[i]). */
export function cellsOf(
  cells: { readonly row: readonly number[]; readonly column: readonly number[] } | undefined,
): CellAt[] {
  if (cells === undefined) return [];
  return cells.row.map((row, i) => ({ row, column: cells.column[i] ?? 0 }));
}

/** Row-major, as all grids of the protocol are. */
export function cellIndex(cell: CellAt, columns: number): number {
  return cell.row * columns + cell.column;
}

export function cellKey(cell: CellAt): string {
  return `${cell.row},${cell.column}`;
}

export function sameCell(a: CellAt | undefined, b: CellAt | undefined): boolean {
  return a !== undefined && b !== undefined && a.row === b.row && a.column === b.column;
}

export function cellText(cell: CellAt | undefined): string {
  return cell === undefined ? "–" : `(${cell.row}, ${cell.column})`;
}

/** Walls of a belief are 255 * P(wall). */
export function isWall(walls: Uint8Array, cell: CellAt, columns: number): boolean {
  return (walls[cellIndex(cell, columns)] ?? 0) >= 128;
}
