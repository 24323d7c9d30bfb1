import type {
  Alert,
  Attention,
  Belief,
  Control,
  Draft,
  Event,
  Form,
  Frame,
  GoalPose,
  Guidance,
  Plan,
  Playback,
  Prediction,
  Presence,
  Robot,
  Search,
  SeenMap,
  Service,
  Session,
  Snapshot,
  StudyLog,
  Task,
  Trail,
  Truth,
  Welcome,
  World,
} from "../protocol/generated/console_pb";

/** Values by key. An update replaces one map; all other maps stay the same objects. */
export interface KeyedState {
  /** By world: */
  readonly worlds: ReadonlyMap<string, World>;
  readonly beliefs: ReadonlyMap<string, Belief>;
  readonly truths: ReadonlyMap<string, Truth>;
  /** By robot: */
  readonly robots: ReadonlyMap<string, Robot>;
  readonly seen: ReadonlyMap<string, SeenMap>;
  readonly plans: ReadonlyMap<string, Plan>;
  readonly searches: ReadonlyMap<string, Search>;
  readonly predictions: ReadonlyMap<string, Prediction>;
  readonly guidance: ReadonlyMap<string, Guidance>;
  readonly goalPoses: ReadonlyMap<string, GoalPose>;
  readonly controls: ReadonlyMap<string, Control>;
  /** Newest frame of each robot that streams. */
  readonly frames: ReadonlyMap<string, Frame>;
  /** By process: */
  readonly services: ReadonlyMap<string, Service>;
}

/** Values without a key. */
interface SingleState {
  readonly session: Session | undefined;
  readonly attention: Attention | undefined;
  readonly presence: Presence | undefined;
  readonly playback: Playback | undefined;
  readonly task: Task | undefined;
  readonly form: Form | undefined;
  readonly draft: Draft | undefined;
  readonly studyLog: StudyLog | undefined;
}

/**
 * All that the page knows about the service, from its messages alone. Immutable: a message makes a new state that shares all
 * unchanged parts, so parts can be compared by identity. The values are the protocol's messages.
 */
export interface ConsoleState extends KeyedState, SingleState {
  readonly welcome: Welcome | undefined;
  /** Whether this is an earlier moment that the person looks at (History): it accepts no commands. */
  readonly isPast: boolean;
  /** For Hello: the run, and the sequence number up to which the state is complete. */
  readonly run: string;
  readonly sequence: bigint;
  /** By robot, then by the number of the first cell. */
  readonly trails: ReadonlyMap<string, ReadonlyMap<number, Trail>>;
  /** By robot, oldest first; at most `mostPictures`. */
  readonly pictures: ReadonlyMap<string, readonly Snapshot[]>;
  /** Oldest first. */
  readonly alerts: readonly Alert[];
  /** The command log, oldest first; at most `mostEvents`. */
  readonly events: readonly Event[];
}

export const mostPictures = 500;
export const mostEvents = 1000;

export const emptyState: ConsoleState = {
  welcome: undefined,
  isPast: false,
  run: "",
  sequence: 0n,
  session: undefined,
  worlds: new Map(),
  beliefs: new Map(),
  truths: new Map(),
  robots: new Map(),
  seen: new Map(),
  trails: new Map(),
  plans: new Map(),
  searches: new Map(),
  predictions: new Map(),
  guidance: new Map(),
  goalPoses: new Map(),
  pictures: new Map(),
  attention: undefined,
  controls: new Map(),
  alerts: [],
  events: [],
  services: new Map(),
  presence: undefined,
  playback: undefined,
  task: undefined,
  form: undefined,
  draft: undefined,
  studyLog: undefined,
  frames: new Map(),
};
