import type { Snapshot } from "../../protocol/generated/console_pb";
import type { GridSize } from "../grid";
import type { Cell, MapRobot } from "../map_props";
import type { Placement } from "../view";

/** Why a wall stands there. */
export type WallKind = "belief" | "confirmed" | "refuted" | "missing";

/** A wall: of the operator's map, or one that robots saw and the map lacks. */
export interface Wall {
  readonly cell: Cell;
  /** Height as a share of a full wall: how probable it is on the operator's map. */
  readonly height: number;
  readonly kind: WallKind;
}

/** What the view in three dimensions shows. */
export interface SolidData {
  readonly world: Placement;
  readonly walls: readonly Wall[];
  readonly robots: readonly MapRobot[];
  readonly chosenRobot: string | undefined;
  /** Each robot's newest picture. */
  readonly newest: readonly Snapshot[];
  readonly paths: ReadonlyMap<string, readonly Cell[]>;
}

/** In SeenMap.cells. */
const seenFree = 1;
const seenWall = 2;

/** Below this probability no wall is drawn. */
const least = 0.1;

const kept = new WeakMap<
  Uint8Array,
  { readonly seen: Uint8Array; readonly walls: readonly Wall[] }
>();

/** Worked out when the map or what robots saw changes. `belief`: 255 * P(wall); `seen`: as SeenMap.cells. */
export function wallsOf(
  { rows, columns }: GridSize,
  belief: Uint8Array | undefined,
  seen: Uint8Array,
): readonly Wall[] {
  const known = belief && kept.get(belief);
  if (known?.seen === seen) return known.walls;
  const walls: Wall[] = [];
  for (let index = 0; index < rows * columns; index += 1) {
    const probability = (belief?.[index] ?? 0) / 255;
    const missing = probability < 0.5 && seen[index] === seenWall;
    if (probability < least && !missing) continue;
    const cell = { row: Math.floor(index / columns), column: index % columns };
    walls.push({ cell, height: missing ? 1 : probability, kind: kindOf(missing, seen[index]) });
  }
  if (belief) kept.set(belief, { seen, walls });
  return walls;
}

function kindOf(missing: boolean, seen: number | undefined): WallKind {
  if (missing) return "missing";
  if (seen === seenWall) return "confirmed";
  return seen === seenFree ? "refuted" : "belief";
}
