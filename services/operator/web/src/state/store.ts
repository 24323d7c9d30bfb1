import { computed, type ReadonlySignal, type Signal, signal } from "@preact/signals";
import type { Link } from "../connection/connection";
import type { Timing } from "../connection/timing";
import type { Tool } from "../map/map_props";
import type { CellAt } from "../protocol/cells";
import type { Robot, ServerMessage, Snapshot } from "../protocol/generated/console_pb";
import { type ConsoleState, emptyState } from "./console_state";
import { History, type Moment } from "./history";
import { reduce } from "./reduce";
import { mayCommand, pictureOf, robotNames } from "./selectors";
import type { Settings } from "./settings";

/** A short message that disappears by itself. */
export interface Notice {
  readonly id: number;
  readonly text: string;
  readonly kind: "info" | "problem";
  /** Page time. */
  readonly until: number;
}

export interface TakeOver {
  readonly robots: readonly string[];
  readonly from: readonly string[];
}

type Dialog =
  | { readonly kind: "help" }
  | { readonly kind: "start" }
  | { readonly kind: "note" }
  | { readonly kind: "take over"; readonly takeOver: TakeOver };

interface Focus {
  readonly cell: CellAt;
  readonly counter: number;
}

interface Accept {
  readonly changes: readonly { readonly cell: CellAt; readonly wall: boolean }[];
  readonly counter: number;
}

/** A picture or a camera that the page shows over the map. */
type Large = { readonly kind: "camera" | "picture"; readonly robot: string };

/** What the page shows, as signals: the state received from the service, and the person's own choices. */
export interface Store {
  /**
   * What the panels show: the newest state, or an earlier one. While robots only move it follows four times a second, with `now`:
   * working out every panel for each report would cost more than all drawing.
   */
  readonly state: ReadonlySignal<ConsoleState>;
  /** The same, following every report, for the map. */
  readonly motion: ReadonlySignal<ConsoleState>;
  /** The newest state. */
  readonly live: ReadonlySignal<ConsoleState>;
  /** The earlier moment that the person looks at; undefined = now. */
  readonly moment: Signal<Moment | undefined>;
  readonly history: History;
  /** The person's name, empty until it is given. */
  readonly name: Signal<string>;
  /** Robots whose cameras the person has opened, at most `mostCameras`. */
  readonly cameras: Signal<readonly string[]>;
  readonly large: Signal<Large | undefined>;
  readonly link: Signal<Link>;
  /** Whether the link is live. Without it nothing looks live. */
  readonly linked: ReadonlySignal<boolean>;
  /** Whether this person can give commands now. Stop always works. */
  readonly canCommand: ReadonlySignal<boolean>;
  readonly timing: Signal<Timing>;
  /** Wall time of the service, or of the earlier moment; updated four times a second. */
  readonly now: Signal<number | undefined>;
  readonly settings: Signal<Settings>;
  readonly tool: Signal<Tool>;
  readonly chosenRobot: Signal<string | undefined>;
  /** Number of the chosen robot's picture; undefined = its newest. */
  readonly chosenSequence: Signal<bigint | undefined>;
  readonly chosenPicture: ReadonlySignal<Snapshot | undefined>;
  readonly robots: ReadonlySignal<readonly string[]>;
  readonly focus: Signal<Focus | undefined>;
  readonly notices: Signal<readonly Notice[]>;
  /** How often the person selected an item of the queue. */
  readonly selections: Signal<number>;
  /** Robots that were to stop, all if it is empty, while the service has not confirmed it. */
  readonly undeliveredStop: Signal<readonly string[] | undefined>;
  /** Requests without a reply. */
  readonly pending: Signal<number>;
  readonly dialog: Signal<Dialog | undefined>;
  /** Speed to resume with after a pause. */
  readonly replaySpeed: Signal<number>;
  /** Changes of the map to be made; see MapProps.accept. */
  readonly accept: Signal<Accept | undefined>;
  receive(...messages: ServerMessage[]): void;
  /** Shows the newest state everywhere; called four times a second. */
  settle(): void;
  choose(robot: string | undefined): void;
  centre(cell: CellAt | undefined): void;
  change(changes: Accept["changes"]): void;
}

export const mostCameras = 2;

/** Robots whose live views are on the page: the chosen one's where the method streams, and the cameras that are open. */
export function camerasShown({ state, chosenRobot, cameras, large }: Store): readonly string[] {
  const streams = state.value.session?.streams ?? false;
  const chosen = streams && chosenRobot.value !== undefined ? [chosenRobot.value] : [];
  const enlarged = large.value?.kind === "camera" ? [large.value.robot] : [];
  return [...new Set([...chosen, ...cameras.value, ...enlarged])];
}

/** Robots whose search reports are on the page: all with the map's layer, else the chosen one's, for the planner's time. */
export function searchesShown({ settings, robots, chosenRobot }: Store): readonly string[] {
  if (settings.value.layers.search > 0) return robots.value;
  return chosenRobot.value === undefined ? [] : [chosenRobot.value];
}

export function createStore(settings: Settings): Store {
  const live = signal(emptyState);
  const moment = signal<Moment | undefined>(undefined);
  const settled = signal(emptyState);
  const motion = computed(() => moment.value?.state ?? live.value);
  const state = computed(() => moment.value?.state ?? settled.value);
  const chosenRobot = signal<string | undefined>(undefined);
  const chosenSequence = signal<bigint | undefined>(undefined);
  const focus = signal<Focus | undefined>(undefined);
  const link = signal<Link>({ state: "connecting" });
  const linked = computed(() => link.value.state === "live");
  const robots = computedByValue(() => robotNames(state.value));
  const store: Store = {
    state,
    motion,
    live,
    moment,
    history: new History(),
    name: signal(""),
    cameras: signal<readonly string[]>([]),
    large: signal<Large | undefined>(undefined),
    link,
    linked,
    canCommand: computed(() => linked.value && mayCommand(state.value)),
    timing: signal<Timing>({ roundTrip: undefined, clockOffset: undefined }),
    now: signal<number | undefined>(undefined),
    settings: signal(settings),
    tool: signal<Tool>("look"),
    chosenRobot,
    chosenSequence,
    // The chosen picture may be gone, as after rewinding a recording: then the newest.
    chosenPicture: computed(
      () =>
        pictureOf(state.value, chosenRobot.value, chosenSequence.value) ??
        pictureOf(state.value, chosenRobot.value),
    ),
    robots,
    focus,
    notices: signal<readonly Notice[]>([]),
    selections: signal(0),
    undeliveredStop: signal<readonly string[] | undefined>(undefined),
    pending: signal(0),
    dialog: signal<Dialog | undefined>(undefined),
    replaySpeed: signal(1),
    accept: signal<Accept | undefined>(undefined),
    receive: (...messages) => {
      live.value = messages.reduce(reduce, live.value);
      if (!onlyMoves(settled.peek(), live.peek())) settled.value = live.peek();
      // The selection never changes by itself, except that the first robot is chosen at the start.
      if (chosenRobot.value === undefined) chosenRobot.value = robots.value[0];
    },
    settle: () => {
      settled.value = live.peek();
    },
    choose: (robot) => {
      if (robot !== chosenRobot.value) chosenSequence.value = undefined;
      chosenRobot.value = robot;
    },
    centre: (cell) => {
      if (cell) focus.value = { cell, counter: (focus.value?.counter ?? 0) + 1 };
    },
    change: (changes) => {
      store.accept.value = { changes, counter: (store.accept.value?.counter ?? 0) + 1 };
    },
  };
  return store;
}

/** Parts of the state that change with every report of a robot. */
const moving: ReadonlySet<string> = new Set([
  "sequence",
  "worlds", // their time
  "robots",
  "seen",
  "trails",
  "plans",
  "searches",
  "predictions",
  "pictures", // of many robots
  "attention",
  "services",
] satisfies (keyof ConsoleState)[]);

/** Whether robots drove on, and did nothing that people are waiting for. */
function onlyMoves(before: ConsoleState, now: ConsoleState): boolean {
  const other = new Map<string, unknown>(Object.entries(before));
  const calm = Object.entries(now).every(
    ([key, value]) => moving.has(key) || other.get(key) === value,
  );
  if (!calm || before.worlds.size !== now.worlds.size) return false;
  return [...now.robots].every(([name, robot]) => {
    const known = before.robots.get(name);
    return known === robot || (known !== undefined && drivesOn(known, robot));
  });
}

function drivesOn(before: Robot, now: Robot): boolean {
  return (
    before.outcome === now.outcome &&
    before.stopped === now.stopped &&
    before.goalsLeft.length === now.goalsLeft.length &&
    before.goalsTotal === now.goalsTotal &&
    before.world === now.world
  );
}

/** Computes a small plain value that changes only when its JSON text does. */
export function computedByValue<T>(source: () => T): ReadonlySignal<T> {
  let kept: { readonly value: T; readonly text: string } | undefined;
  return computed(() => {
    const value = source();
    const text = JSON.stringify(value);
    if (kept?.text !== text) kept = { value, text };
    return kept.value;
  });
}
