/**
 * Position of the grid on the map's canvas while the whole map is shown, in CSS pixels from the canvas's upper left corner. Also
 * runs in pages, as text, so it must not use anything else of this file.
 * @param {{ width: number, height: number }} canvas
 * @param {{ rows: number, columns: number }} size
 */
export function fittedGrid(canvas, { rows, columns }) {
  const [ruler, margin] = [24, 8];
  const room = {
    width: canvas.width - ruler - 2 * margin,
    height: canvas.height - ruler - 2 * margin,
  };
  const scale = Math.min(room.width / columns, room.height / rows);
  const left = ruler + margin + (room.width - scale * columns) / 2;
  const top = ruler + margin + (room.height - scale * rows) / 2;
  return { left, top, scale };
}
