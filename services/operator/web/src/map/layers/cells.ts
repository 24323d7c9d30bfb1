import type { Prediction } from "../../protocol/generated/console_pb";
import { type Draw, isolated } from "../draw/context";
import type { Palette } from "../draw/palette";
import { hatchPath } from "../draw/shapes";
import type { Draft } from "../edit_session";
import {
  type Cell,
  cellOfIndex,
  freeCell,
  type GridSize,
  isWallAt,
  unknownCell,
  wallCell,
} from "../grid";
import { cellCentre, cellCorner, type View, visibleRange } from "../view";
import { heatStrength } from "./cell_looks";

type ChangesData = {
  readonly size: GridSize;
  readonly walls: Uint8Array;
  readonly initial: Uint8Array;
};

/** The operator's changes since the initial map: plus = wall added, minus = wall removed. For large cells. */
export function drawChanges(context: Draw, view: View, data: ChangesData, palette: Palette): void {
  isolated(context, () => {
    context.strokeStyle = palette.changed;
    context.fillStyle = palette.changed;
    context.lineCap = "round";
    eachVisible(view, data.size, (cell, index) => {
      const added = isWallAt(data.walls, index);
      if (added === isWallAt(data.initial, index)) return;
      const corner = cellCorner(view, cell);
      context.globalAlpha = 0.3;
      context.fillRect(corner.x, corner.y, view.scale, view.scale);
      drawSign(context, view, cellCentre(view, cell), added);
    });
  });
}

function drawSign(context: Draw, view: View, at: { x: number; y: number }, plus: boolean): void {
  const reach = Math.min(8, 0.22 * view.scale);
  context.globalAlpha = 1;
  context.lineWidth = Math.max(1.5, Math.min(3, 0.08 * view.scale));
  context.beginPath();
  context.moveTo(at.x - reach, at.y);
  context.lineTo(at.x + reach, at.y);
  if (plus) {
    context.moveTo(at.x, at.y - reach);
    context.lineTo(at.x, at.y + reach);
  }
  context.stroke();
}

type EditsData = {
  readonly size: GridSize;
  readonly stroke: Draft;
  readonly pending: readonly Draft[];
  readonly refused: Draft;
};

/** Unconfirmed edits: added walls hatched, removed walls cleared, both framed. Refused ones have their own colour. */
export function drawEdits(context: Draw, view: View, data: EditsData, palette: Palette): void {
  const paint = (draft: Draft, colour: string, dash: number[]) => {
    isolated(context, () => {
      context.strokeStyle = colour;
      context.lineWidth = view.scale >= 8 ? 2 : 1;
      context.setLineDash(dash);
      const { top, left, bottom, right } = visibleRange(view, data.size);
      for (const [index, wall] of draft) {
        const cell = cellOfIndex(data.size, index);
        if (cell.row < top || cell.row > bottom || cell.column < left || cell.column > right)
          continue;
        drawEdit(context, view, cellCorner(view, cell), wall, palette);
      }
    });
  };
  paint(data.refused, palette.refused, []);
  for (const draft of data.pending) paint(draft, palette.draft, [3, 3]);
  paint(data.stroke, palette.draft, []);
}

function drawEdit(
  context: Draw,
  view: View,
  corner: { x: number; y: number },
  wall: boolean,
  palette: Palette,
): void {
  const inset = Math.min(2, 0.08 * view.scale);
  const size = view.scale - 2 * inset;
  const inner = { x: corner.x + inset, y: corner.y + inset };
  context.fillStyle = wall ? palette.wall : palette.free;
  context.globalAlpha = wall ? 0.55 : 0.85;
  context.fillRect(corner.x, corner.y, view.scale, view.scale);
  context.globalAlpha = 1;
  context.beginPath();
  context.rect(inner.x, inner.y, size, size);
  if (wall && view.scale >= 8) hatchPath(context, inner, size, false);
  context.stroke();
}

type HeatData = { readonly size: GridSize; readonly predictions: Iterable<Prediction> };

/** Edits that the model expects from the operator: rising lines = add a wall, falling lines = remove one. For large cells. */
export function drawHeat(context: Draw, view: View, data: HeatData, palette: Palette): void {
  isolated(context, () => {
    for (const { add, remove } of data.predictions) {
      eachVisible(view, data.size, (cell, index) => {
        const corner = cellCorner(view, cell);
        heatCell(context, corner, view, add[index] ?? 0, palette.add, false);
        heatCell(context, corner, view, remove[index] ?? 0, palette.remove, true);
      });
    }
  });
}

function heatCell(
  context: Draw,
  corner: { x: number; y: number },
  view: View,
  value: number,
  colour: string,
  falling: boolean,
): void {
  const strength = heatStrength(value);
  if (strength === 0) return;
  context.fillStyle = colour;
  context.strokeStyle = colour;
  context.globalAlpha = strength;
  context.fillRect(corner.x, corner.y, view.scale, view.scale);
  context.globalAlpha = 0.35 + 0.65 * (value / 255);
  context.lineWidth = 1.5;
  context.beginPath();
  hatchPath(context, corner, view.scale, falling);
  context.stroke();
}

type SeenData = {
  readonly size: GridSize;
  readonly walls: Uint8Array; // operator's map
  readonly seen: Uint8Array;
};

/** Where the operator's map differs from what robots saw: hatched square = they saw a wall, ring = they saw it free. For large cells. */
export function drawDifferences(context: Draw, view: View, data: SeenData, palette: Palette): void {
  isolated(context, () => {
    context.strokeStyle = palette.differs;
    context.lineWidth = Math.max(1.5, Math.min(3, 0.07 * view.scale));
    eachVisible(view, data.size, (cell, index) => {
      const seen = data.seen[index] ?? unknownCell;
      const wall = isWallAt(data.walls, index);
      if (!(seen === wallCell && !wall) && !(seen === freeCell && wall)) return;
      const { x, y } = cellCorner(view, cell);
      if (wall) drawRing(context, view, cellCentre(view, cell));
      else drawSeenWall(context, { x, y }, view.scale);
    });
  });
}

function drawRing(context: Draw, view: View, at: { x: number; y: number }): void {
  context.beginPath();
  context.arc(at.x, at.y, 0.26 * view.scale, 0, 2 * Math.PI);
  context.stroke();
}

function drawSeenWall(context: Draw, corner: { x: number; y: number }, scale: number): void {
  const inset = 0.14 * scale;
  const size = scale - 2 * inset;
  const inner = { x: corner.x + inset, y: corner.y + inset };
  context.beginPath();
  context.rect(inner.x, inner.y, size, size);
  hatchPath(context, inner, size, false);
  context.stroke();
}

type TruthData = {
  readonly size: GridSize;
  readonly walls: Uint8Array; // operator's map
  readonly truth: Uint8Array;
};

/** The true walls as frames, with crosses where the operator's map is wrong. For large cells. */
export function drawTruth(context: Draw, view: View, data: TruthData, palette: Palette): void {
  isolated(context, () => {
    context.strokeStyle = palette.truth;
    context.lineWidth = Math.max(1, Math.min(2.5, 0.06 * view.scale));
    eachVisible(view, data.size, (cell, index) => {
      const wall = data.truth[index] === wallCell;
      const wrong = wall !== isWallAt(data.walls, index);
      const { x, y } = cellCorner(view, cell);
      const inset = 0.1 * view.scale;
      const size = view.scale - 2 * inset;
      if (wall) context.strokeRect(x + inset, y + inset, size, size);
      if (wrong) drawCross(context, x + inset, y + inset, size);
    });
  });
}

function drawCross(context: Draw, x: number, y: number, size: number): void {
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(x + size, y + size);
  context.moveTo(x + size, y);
  context.lineTo(x, y + size);
  context.stroke();
}

/** Calls `visit` for each visible cell, row by row. */
function eachVisible(view: View, size: GridSize, visit: (cell: Cell, index: number) => void): void {
  const range = visibleRange(view, size);
  for (let row = range.top; row <= range.bottom; ++row) {
    for (let column = range.left; column <= range.right; ++column) {
      visit({ row, column }, row * size.columns + column);
    }
  }
}
