import type {
  Belief,
  GoalPose,
  Guidance,
  Plan,
  Prediction,
  Robot,
  Search,
  SeenMap,
  Snapshot,
  Truth,
  World,
} from "../protocol/generated/console_pb";
import type { Cell } from "./grid";

export type { Cell } from "./grid";

export type RobotShape = "circle" | "square" | "triangle" | "diamond" | "pentagon" | "star";

/** Age of a robot's newest state; "unknown" without a link. */
export type Freshness = "live" | "stale" | "lost" | "unknown";

/** A robot and its look. Robots differ even without colour. */
export type MapRobot = {
  robot: Robot;
  colour: string; // CSS colour
  shape: RobotShape;
  dash: readonly number[]; // of its lines, CSS pixels; empty = solid
  letter: string; // in its mark, 1 or 2 characters
  fresh: Freshness;
  stopped: boolean; // by somebody, until somebody resumes it
};

export type Tool = "look" | "wall" | "erase" | "rectangle" | "path" | "goal";

export function editsMap(tool: Tool): boolean {
  return tool !== "look" && tool !== "path" && tool !== "goal";
}

/** Whether a tool can be chosen now. */
export function offers(props: Pick<MapProps, "offersPaths" | "offersGoals">, tool: Tool): boolean {
  return (tool !== "path" || props.offersPaths) && (tool !== "goal" || props.offersGoals);
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
/** Opacity of each layer, from 0 to 1. */
export type Layers = Readonly<Record<LayerName, number>>;

/** Layers of a new page. */
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

/** Whether something is allowed now. The reason is a text for the person. */
export type Permission = { allowed: true } | { allowed: false; reason: string };

export type CellChange = { readonly cell: Cell; readonly wall: boolean };

/** The service's reply to a request; `reason` is empty if it was accepted. */
export type Outcome = { accepted: boolean; reason: string };

/**
 * All data that the map shows, and all requests that it sends. For the world `world` only: the caller leaves out robots,
 * pictures, ... of other worlds. The maps are keyed by robot name. Byte arrays are compared by identity: a new value is
 * a new array.
 */
export type MapProps = {
  world: World;
  belief: Belief | undefined; // undefined = not received yet
  robots: readonly MapRobot[];
  seen: ReadonlyMap<string, SeenMap>;
  trails: ReadonlyMap<string, readonly Cell[]>; // in the order in which the robot entered them
  plans: ReadonlyMap<string, Plan>;
  searches: ReadonlyMap<string, Search>;
  predictions: ReadonlyMap<string, Prediction>;
  guidance: ReadonlyMap<string, Guidance>;
  pictures: readonly Snapshot[];
  chosenPicture: Snapshot | undefined; // its cells are marked
  goalPoses: ReadonlyMap<string, GoalPose>;
  truth: Truth | undefined; // only in replay

  layers: Layers;
  onLayers: (layers: Layers) => void;
  chosenRobot: string | undefined;
  onChooseRobot: (name: string) => void;
  tool: Tool;
  onTool: (tool: Tool) => void;

  /** For observers and recordings: no tools that change something. */
  readOnly: boolean;
  /** For participants: no layers that reveal the solution. */
  participates: boolean;
  /** What was: to look at only. Undo and drafts wait. */
  isPast: boolean;
  /** Whether robots follow paths, so that there is a path tool. */
  offersPaths: boolean;
  /** Whether the chosen robot's goals are set here. */
  offersGoals: boolean;
  /** Whether the arrow keys drive a robot. Then the map uses them only with a tool that edits. */
  arrowsDrive: boolean;
  mayEdit: Permission;
  mayGuide: Permission; // of the chosen robot
  /** Whether the chosen robot is stopped. It ignores its path until somebody resumes it. */
  stopped: boolean;
  /** Maximum number of cells per edit; larger ones are sent in parts. Undefined: no limit. */
  editLimit?: number | undefined;
  /** Resolves with the service's reply. The edit is pending until then, and until a belief with a newer revision arrives. */
  onEdit: (world: string, cells: readonly CellChange[], baseRevision: bigint) => Promise<Outcome>;
  /** An empty path withdraws. */
  onPath: (robot: string, cells: readonly Cell[]) => Promise<Outcome>;
  /** Adds goals to the robot's, and removes those in the cells `remove`. */
  onGoals: (robot: string, add: readonly Cell[], remove: readonly Cell[]) => Promise<Outcome>;

  /** Name of a client such as `Guidance.givenBy`. */
  nameOf: (client: string) => string;

  /** Makes these changes whenever `counter` changes, like an edit by hand: undo takes them back. */
  accept?: { changes: readonly CellChange[]; counter: number } | undefined;

  /** Centres the map on the cell whenever `counter` changes, unless the whole map is visible. */
  focus?: { cell: Cell; counter: number } | undefined;
};
