// For tests: a small world, and a page that records the map's requests.
import { create } from "@bufbuild/protobuf";
import { BeliefSchema, RobotSchema, WorldSchema } from "../protocol/generated/console_pb";
import {
  type Cell,
  type CellChange,
  defaultLayers,
  type MapProps,
  type MapRobot,
  type Outcome,
} from "./map_props";

export const at = (row: number, column: number): Cell => ({ row, column });

/** # = wall. */
export const worldRows = ["#######", "#.....#", "#.#.#.#", "#.....#", "#######"] as const;

function wallsOf(rows: readonly string[]): Uint8Array {
  return Uint8Array.from(rows.join(""), (letter) => (letter === "#" ? 255 : 0));
}

export function beliefOf(rows: readonly string[], revision: bigint) {
  const walls = wallsOf(rows);
  return create(BeliefSchema, { world: "w1", revision, walls, initialWalls: walls });
}

export function robotIn(name: string, cell: Cell): MapRobot {
  // Cells of 2 m; the grid's middle is the origin.
  const position = { x: 2 * (cell.column + 0.5) - 7, y: 5 - 2 * (cell.row + 0.5) };
  const robot = create(RobotSchema, { name, world: "w1", cell, ...position });
  const look = { colour: "#d55e00", shape: "circle", dash: [], letter: "A" } as const;
  return { robot, ...look, fresh: "live", stopped: false };
}

type Asked =
  | { kind: "edit"; world: string; cells: readonly CellChange[]; base: bigint }
  | { kind: "path"; robot: string; cells: readonly Cell[] }
  | { kind: "goals"; robot: string; add: readonly Cell[]; remove: readonly Cell[] }
  | { kind: "robot"; name: string }
  | { kind: "tool"; tool: MapProps["tool"] };

/** Replies as `outcome` says. */
export class FakePage {
  readonly asked: Asked[] = [];
  outcome: Outcome = { accepted: true, reason: "" };
  props: MapProps;

  constructor(more: Partial<MapProps> = {}) {
    const none = new Map<string, never>();
    this.props = {
      world: create(WorldSchema, { name: "w1", rows: 5, columns: 7, cellSize: 2 }),
      belief: beliefOf(worldRows, 3n),
      robots: [robotIn("r1", at(1, 1)), robotIn("r2", at(3, 5))],
      seen: none,
      trails: none,
      plans: none,
      searches: none,
      predictions: none,
      guidance: none,
      pictures: [],
      chosenPicture: undefined,
      goalPoses: none,
      truth: undefined,
      layers: defaultLayers,
      onLayers: () => {},
      chosenRobot: "r1",
      onChooseRobot: (name) => this.asked.push({ kind: "robot", name }),
      tool: "look",
      nameOf: (client) => client,
      onTool: (tool) => this.asked.push({ kind: "tool", tool }),
      readOnly: false,
      participates: false,
      isPast: false,
      offersPaths: true,
      offersGoals: false,
      arrowsDrive: false,
      mayEdit: { allowed: true },
      mayGuide: { allowed: true },
      stopped: false,
      onEdit: async (world, cells, base) => {
        this.asked.push({ kind: "edit", world, cells, base });
        return this.outcome;
      },
      onPath: async (robot, cells) => {
        this.asked.push({ kind: "path", robot, cells });
        return this.outcome;
      },
      onGoals: async (robot, add, remove) => {
        this.asked.push({ kind: "goals", robot, add, remove });
        return this.outcome;
      },
      ...more,
    };
  }
}
