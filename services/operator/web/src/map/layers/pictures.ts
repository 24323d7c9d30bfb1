import { cellsOf } from "../../protocol/cells";
import { type Snapshot, SnapshotAnswer } from "../../protocol/generated/console_pb";
import { type Draw, isolated } from "../draw/context";
import { CachedLayer } from "../draw/offscreen";
import type { Palette } from "../draw/palette";
import { conePath, hatchPath } from "../draw/shapes";
import type { GridSize } from "../grid";
import type { Cell, MapRobot } from "../map_props";
import { cellCentre, cellCorner, type Point, type View } from "../view";

type PicturesData = {
  readonly robots: readonly MapRobot[];
  readonly pictures: readonly Snapshot[];
};

/** Position and field of view of each picture; filled while it waits for an answer. */
export function drawPictures(
  context: Draw,
  view: View,
  data: PicturesData,
  palette: Palette,
): void {
  const colours = new Map(data.robots.map(({ robot, colour }) => [robot.name, colour]));
  isolated(context, () => {
    context.lineWidth = 1.5;
    context.lineJoin = "round";
    for (const picture of data.pictures) {
      if (!picture.cell) continue;
      const at = cellCentre(view, picture.cell);
      const waits = picture.answer === SnapshotAnswer.ANSWER_NONE;
      const colour = colours.get(picture.robot) ?? palette.muted;
      context.strokeStyle = colour;
      context.fillStyle = colour;
      conePath(context, at, picture.heading, picture.fieldOfView, Math.max(9, 0.62 * view.scale));
      context.globalAlpha = waits ? 0.45 : 0.12;
      context.fill();
      context.globalAlpha = waits ? 1 : 0.65;
      context.stroke();
    }
  });
}

/** The chosen picture's content: a dot per free cell and a hatched frame per wall, within its field of view. */
export function drawChosenPicture(
  context: Draw,
  view: View,
  data: { size: GridSize; picture: Snapshot; colour: string },
  palette: Palette,
): void {
  const { size, picture, colour } = data;
  if (!picture.cell) return;
  const at = cellCentre(view, picture.cell);
  isolated(context, () => {
    context.beginPath();
    context.rect(view.x, view.y, size.columns * view.scale, size.rows * view.scale);
    context.clip();
    drawField(context, view, at, data);
    context.globalAlpha = 1;
    for (const cell of cellsOf(picture.freeCells))
      drawFreeCell(context, view, cell, colour, palette);
    for (const cell of cellsOf(picture.wallCells))
      drawWallCell(context, view, cell, colour, palette);
  });
}

function drawField(
  context: Draw,
  view: View,
  at: Point,
  { picture, colour }: { picture: Snapshot; colour: string },
): void {
  const from = picture.cell;
  const far = [...cellsOf(picture.freeCells), ...cellsOf(picture.wallCells)].map((cell) =>
    from ? Math.hypot(cell.row - from.row, cell.column - from.column) : 0,
  );
  const least = far.length > 0 ? 2 : 5; // participants do not get the picture's cells
  const reach = (Math.min(12, Math.max(least, ...far)) + 0.5) * view.scale;
  conePath(context, at, picture.heading, picture.fieldOfView, reach);
  context.fillStyle = colour;
  context.strokeStyle = colour;
  context.globalAlpha = 0.14;
  context.fill();
  context.globalAlpha = 0.8;
  context.lineWidth = 1.5;
  context.setLineDash([5, 4]);
  context.stroke();
  context.setLineDash([]);
}

function drawFreeCell(
  context: Draw,
  view: View,
  cell: Cell,
  colour: string,
  palette: Palette,
): void {
  const at = cellCentre(view, cell);
  context.beginPath();
  context.arc(at.x, at.y, Math.max(1.2, Math.min(5, 0.13 * view.scale)), 0, 2 * Math.PI);
  context.fillStyle = colour;
  context.strokeStyle = palette.halo;
  context.lineWidth = 1.5;
  context.stroke();
  context.fill();
}

function drawWallCell(
  context: Draw,
  view: View,
  cell: Cell,
  colour: string,
  palette: Palette,
): void {
  const corner = cellCorner(view, cell);
  const inset = Math.min(3, 0.1 * view.scale);
  const size = view.scale - 2 * inset;
  const inner = { x: corner.x + inset, y: corner.y + inset };
  context.beginPath();
  context.rect(inner.x, inner.y, size, size);
  context.strokeStyle = palette.halo;
  context.lineWidth = 4;
  context.stroke();
  if (view.scale >= 14) hatchPath(context, inner, size, true);
  context.strokeStyle = colour;
  context.lineWidth = 2;
  context.stroke();
}

/** Share of marks on screen that may belong to dropped pictures before all are redrawn. */
const mostForgotten = 0.1;

/** Marks where pictures were taken. There may be thousands, so answered ones are drawn once and waiting ones in each frame. */
export class PictureMarks {
  #layer = new CachedLayer();
  #drawn = new Set<Snapshot>();
  #epoch = 0;

  draw(onto: Draw, view: View, { robots, pictures }: PicturesData, palette: Palette): void {
    const waits = ({ answer }: Snapshot) => answer === SnapshotAnswer.ANSWER_NONE;
    const settled = pictures.filter((picture) => !waits(picture));
    const fresh = settled.filter((picture) => !this.#drawn.has(picture));
    const forgotten = this.#drawn.size - (settled.length - fresh.length);
    if (forgotten > mostForgotten * settled.length) this.#epoch += 1;
    const looks = robots.map(({ robot, colour }) => `${robot.name} ${colour}`).join();
    const paint = (some: readonly Snapshot[]) => (on: Draw) => {
      for (const picture of some) this.#drawn.add(picture);
      drawPictures(on, view, { robots, pictures: some }, palette);
    };
    const paintAll = (on: Draw) => {
      this.#drawn.clear();
      paint(settled)(on);
    };
    this.#layer.draw(onto, view, [palette, looks, this.#epoch], paintAll, paint(fresh));
    drawPictures(onto, view, { robots, pictures: pictures.filter(waits) }, palette);
  }
}
