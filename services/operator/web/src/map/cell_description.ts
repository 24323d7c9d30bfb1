import type { SeenMap } from "../protocol/generated/console_pb";
import {
  type Cell,
  cellIndex,
  cellText,
  freeCell,
  type GridSize,
  isWall,
  sameCell,
  wallCell,
} from "./grid";

type CellFacts = {
  readonly size: GridSize;
  readonly walls: Uint8Array | undefined; // operator's map
  readonly seen: ReadonlyMap<string, SeenMap>;
  readonly robots: readonly { name: string; cell?: Cell | undefined; goalsLeft: readonly Cell[] }[];
};

/** What is known about a cell, as one line of text. */
export function describeCell(cell: Cell, facts: CellFacts): string {
  const parts = [mapText(cell, facts), ...seenText(cell, facts), ...robotText(cell, facts)];
  const text = parts.join("; ");
  return `${capital(cellText(cell))}: ${text}.`;
}

function mapText(cell: Cell, { size, walls }: CellFacts): string {
  if (!walls) return "waiting for your map";
  return `${isWall(walls, size, cell) ? "wall" : "free"} on your map`;
}

/** Empty for participants, who may not know what robots saw. */
function seenText(cell: Cell, { size, seen }: CellFacts): string[] {
  if (seen.size === 0) return [];
  const index = cellIndex(size, cell);
  const by = (value: number) =>
    [...seen].filter(([, map]) => map.cells[index] === value).map(([name]) => name);
  const part = (names: string[], what: string) =>
    names.length > 0 ? [`${names.join(", ")} saw ${what}`] : [];
  const known = [...part(by(wallCell), "a wall"), ...part(by(freeCell), "it free")];
  return known.length > 0 ? known : ["not seen by any robot"];
}

function robotText(cell: Cell, { robots }: CellFacts): string[] {
  const isHere = (other: Cell) => sameCell(other, cell);
  const standing = robots.filter((robot) => robot.cell && isHere(robot.cell));
  const goals = robots.filter((robot) => robot.goalsLeft.some(isHere));
  return [
    ...standing.map(({ name }) => `${name} is here`),
    ...goals.map(({ name }) => `goal of ${name}`),
  ];
}

function capital(text: string): string {
  return text.slice(0, 1).toUpperCase() + text.slice(1);
}
