import type {
  Belief,
  GoalPose,
  Guidance,
  Picture,
  Plan,
  Prediction,
  Robot,
  Search,
  SeenMap,
  Truth,
  World,
} from "../protocol/generated/console_pb";
import type { Cell } from "./grid";

export type { Cell } from "./grid";

export type RobotShape = "circle" | "square" | "triangle" | "diamond" | "pentagon" | "star";

/** How old what a robot tells is, counted from when it said so; "no news": without a link nobody can be heard. */
export type Freshness = "live" | "stale" | "lost" | "no news";

/** A robot and how it looks, so that robots can be told apart without their colour. */
export type MapRobot = {
  robot: Robot;
  colour: string; // CSS colour
  shape: RobotShape;
  dash: readonly number[]; // of its lines, CSS pixels; empty = solid
  letter: string; // in its mark, 1 or 2 characters
  fresh: Freshness;
};

export type Tool = "look" | "wall" | "erase" | "rectangle" | "path";

export function editsMap(tool: Tool): boolean {
  return tool !== "look" && tool !== "path";
}

export const layerNames = [
  "belief",
  "changes",
  "seen",
  "heat",
  "plan",
  "search",
  "trails",
  "pictures",
  "goals",
  "paths",
  "goalPoses",
  "truth",
] as const;

export type LayerName = (typeof layerNames)[number];
/** How much of each shows: 0 = nothing, 1 = all. */
export type Layers = Readonly<Record<LayerName, number>>;

/** What a new page shows. */
export const defaultLayers: Layers = {
  belief: 1,
  changes: 1,
  seen: 1,
  heat: 0,
  plan: 1,
  search: 0,
  trails: 1,
  pictures: 1,
  goals: 1,
  paths: 1,
  goalPoses: 1,
  truth: 0,
};

/** Whether something may be done now, and if not, why, in words for the person. */
export type Permission = { allowed: true } | { allowed: false; reason: string };

export type CellChange = { cell: Cell; wall: boolean };

/** What the service said to a request; `reason` is empty when it was accepted. */
export type Outcome = { accepted: boolean; reason: string };

/**
 * Everything that the map shows and all that it can ask for. Of the world `world` only: the caller leaves out the
 * robots, pictures, ... of other worlds. The maps have a robot's name as key. Byte arrays are compared by identity:
 * a new value is a new array.
 */
export type MapProps = {
  world: World;
  belief: Belief | undefined; // undefined = has not come yet
  robots: readonly MapRobot[];
  seen: ReadonlyMap<string, SeenMap>;
  trails: ReadonlyMap<string, readonly Cell[]>; // in the order in which the robot entered them
  plans: ReadonlyMap<string, Plan>;
  searches: ReadonlyMap<string, Search>;
  predictions: ReadonlyMap<string, Prediction>;
  guidance: ReadonlyMap<string, Guidance>;
  pictures: readonly Picture[];
  chosenPicture: Picture | undefined; // what it shows is marked
  goalPoses: ReadonlyMap<string, GoalPose>;
  truth: Truth | undefined; // only in replay

  layers: Layers;
  onLayers: (layers: Layers) => void;
  chosenRobot: string | undefined;
  onChooseRobot: (name: string) => void;
  tool: Tool;
  onTool: (tool: Tool) => void;

  /** An observer or a recording: no tools that change something. */
  readOnly: boolean;
  /** A participant's: no layers of what they are not told. */
  participates: boolean;
  /** Where the robot follows no paths there is no tool for them. */
  offersPaths: boolean;
  /** The arrow keys drive a robot: the map takes them only while a tool that edits is chosen. */
  arrowsDrive: boolean;
  mayEdit: Permission;
  mayGuide: Permission; // of the chosen robot
  /** The chosen robot was stopped: it stands, whatever its path, until somebody lets it go on. */
  stopped: boolean;
  /** At most so many cells in one edit; a larger one is sent in parts. Not given: no limit. */
  editLimit?: number | undefined;
  /** Resolves with the service's reply. Until then, and until a belief with a newer revision came, the edit is pending. */
  onEdit: (world: string, cells: readonly CellChange[], baseRevision: bigint) => Promise<Outcome>;
  /** An empty path withdraws. */
  onPath: (robot: string, cells: readonly Cell[]) => Promise<Outcome>;

  /** Of a client, as people read it; `Guidance.givenBy` is one. */
  nameOf: (client: string) => string;

  /** Unless all of the map is in sight: centres it on the cell whenever `counter` changes. */
  focus?: { cell: Cell; counter: number } | undefined;
};
