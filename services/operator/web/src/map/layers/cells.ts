import type { Cell, GridSize } from "../grid";
import { type View, visibleRange } from "../view";

/** Calls `visit` for each cell in sight, row by row. */
export function eachVisible(
  view: View,
  size: GridSize,
  visit: (cell: Cell, index: number) => void,
): void {
  const range = visibleRange(view, size);
  for (let row = range.top; row <= range.bottom; ++row) {
    for (let column = range.left; column <= range.right; ++column) {
      visit({ row, column }, row * size.columns + column);
    }
  }
}
