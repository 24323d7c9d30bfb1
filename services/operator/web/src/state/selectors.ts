import { type CellAt, cellIndex, cellsOf, isWallAt } from "../protocol/cells";
import {
  type Alert,
  type AttentionItem,
  AttentionReason,
  type Belief,
  CommandOutcome,
  type Control,
  Mode,
  Role,
  type Snapshot,
  SnapshotAnswer,
  type Trail,
  type World,
} from "../protocol/generated/console_pb";
import type { ConsoleState } from "./console_state";

/** r2 comes before r10. */
const byName = new Intl.Collator("en", { numeric: true });

/** In the order of the configuration; other robots come last. */
export function robotNames(state: ConsoleState): readonly string[] {
  const named = state.session?.robots ?? [];
  const others = [...state.robots.keys()]
    .filter((name) => !named.includes(name))
    .sort(byName.compare);
  return [...named, ...others];
}

export function worldOf(state: ConsoleState, robot: string | undefined): World | undefined {
  const name = state.robots.get(robot ?? "")?.world ?? state.session?.worlds[0];
  return name === undefined ? state.worlds.values().next().value : state.worlds.get(name);
}

/** Observers and viewers of the past cannot command. */
export function mayCommand(state: ConsoleState): boolean {
  const { welcome, isPast } = state;
  if (welcome === undefined || isPast) return false;
  return !onlyWatches(state) && welcome.mode !== Mode.REPLAY;
}

/** Observers, and experimenters, who watch a participant. */
export function onlyWatches({ welcome }: ConsoleState): boolean {
  return welcome?.role === Role.OBSERVER || welcome?.role === Role.EXPERIMENTER;
}

/**
 * The run's clock, s: what queue, pictures and deadlines are measured by. Simulation time, or the robots' own; between two
 * reports it goes on like the wall clock. `now`: wall time of the service.
 */
export function runTime(state: ConsoleState, now: number | undefined): number {
  const { robots, attention } = state;
  const times = [...robots.values()].map(
    ({ stamp, receivedAt }) => stamp + Math.max(0, (now ?? receivedAt) - receivedAt),
  );
  return Math.max(0, attention?.stamp ?? 0, ...times);
}

/** Everybody who is connected to a running session may stop robots. */
export function mayStop({ welcome }: ConsoleState): boolean {
  return welcome?.mode !== Mode.REPLAY;
}

/** A client as people read it: "you", or the name of a person who is or was here. */
export function nameOf({ presence, welcome }: ConsoleState, client: string): string {
  if (client === welcome?.client) return "you";
  const here = presence?.people.find((person) => person.client === client);
  return here?.name || readable(client);
}

/** A text of the service with names in place of client ids: "you have control of r1". */
export function withNames(state: ConsoleState, text: string): string {
  const here = state.presence?.people.map(({ client }) => client) ?? [];
  const known = [state.welcome?.client ?? "", ...here].filter((client) => client.includes("/"));
  const named = known.reduce(
    (result, client) => result.replaceAll(client, () => nameOf(state, client)),
    text,
  );
  return named.replace(clients, readable).replace(/\byou has\b/g, "you have");
}

/** Client ids of pages and of programs. */
const clients = /\S+\/[0-9a-f]{16}\b|\S+-[0-9a-f]{8,}-[0-9a-f]+\b/g;

/** The name in a client id such as "Ben/2" or "synthetic-operator-01a2176bd43c-4c91e7b4". */
function readable(client: string): string {
  return client.replace(/\/.*$/, "").replace(/-[0-9a-f]{8,}-[0-9a-f]+$/, "");
}

export type Holder =
  | { readonly kind: "nobody" }
  | { readonly kind: "me"; readonly until: number }
  | { readonly kind: "other"; readonly name: string; readonly reason: string };

/** Somebody who asks this page for control of robots. */
export interface ControlQuestion {
  readonly client: string;
  readonly name: string;
  readonly reason: string;
  readonly robots: readonly string[];
}

/** Questions to this page, one for each person who asks. */
export function questionsToMe({ controls, welcome }: ConsoleState): readonly ControlQuestion[] {
  const questions = new Map<string, ControlQuestion>();
  for (const { robot, holder, askedBy, askedByName, askReason } of controls.values()) {
    if (askedBy === "" || holder !== welcome?.client) continue;
    const robots = [...(questions.get(askedBy)?.robots ?? []), robot];
    const name = askedByName || readable(askedBy);
    questions.set(askedBy, { client: askedBy, name, reason: askReason, robots });
  }
  return [...questions.values()];
}

/** Robots that this page has asked another for. */
export function askedByMe({ controls, welcome }: ConsoleState): readonly string[] {
  return [...controls.values()]
    .filter(({ askedBy }) => askedBy !== "" && askedBy === welcome?.client)
    .map(({ robot }) => robot);
}

export function holderOf(state: ConsoleState, robot: string): Holder {
  const control = state.controls.get(robot);
  if (control === undefined || control.holder === "") return { kind: "nobody" };
  if (control.holder === state.welcome?.client) return { kind: "me", until: control.heldUntil };
  const name = readable(control.holderName || control.holder);
  return { kind: "other", name, reason: control.reason };
}

/** Why this page may not command `robot` now; undefined = it may. */
export function commandBlockedReason(state: ConsoleState, robot: string): string | undefined {
  if (state.welcome === undefined) return "not connected";
  if (state.welcome.mode === Mode.REPLAY) return "this is a recording";
  if (state.isPast) return "you are looking at the past";
  if (onlyWatches(state)) return "you are an observer";
  const holder = holderOf(state, robot);
  return holder.kind === "other" ? `${holder.name} has control of ${robot}` : undefined;
}

/** A robot's picture number `sequence`, or its newest. */
export function pictureOf(
  state: ConsoleState,
  robot: string | undefined,
  sequence?: bigint,
): Snapshot | undefined {
  const all = state.pictures.get(robot ?? "") ?? [];
  return sequence === undefined
    ? all.at(-1)
    : all.find(({ sequenceNumber }) => sequenceNumber === sequence);
}

/** Pictures that wait for an answer of this page, differ from the map, and do not any longer after `changes`. */
export function picturesSettledBy(
  state: ConsoleState,
  world: string,
  changes: readonly { readonly cell: CellAt; readonly wall: boolean }[],
): readonly Snapshot[] {
  const belief = state.beliefs.get(world);
  const columns = state.worlds.get(world)?.columns;
  if (belief === undefined || columns === undefined) return [];
  const walls = belief.walls.slice();
  for (const { cell, wall } of changes) walls[cellIndex({ columns }, cell)] = wall ? 255 : 0;
  const differs = (picture: Snapshot, map: Belief) => {
    const { missing, wrong } = differenceOf(picture, map, columns);
    return missing.length + wrong.length > 0;
  };
  return robotNames(state).flatMap((robot) => {
    const picture = unanswered(state, robot);
    if (picture?.world !== world || commandBlockedReason(state, robot) !== undefined) return [];
    return differs(picture, belief) && !differs(picture, { ...belief, walls }) ? [picture] : [];
  });
}

/** The robot's newest picture, if it waits for an answer. */
export function unanswered(state: ConsoleState, robot: string | undefined): Snapshot | undefined {
  const newest = pictureOf(state, robot);
  return newest?.answer === SnapshotAnswer.ANSWER_NONE ? newest : undefined;
}

/**
 * What robots wait for: one item for each robot, the service's first, but a first path only where nothing else waits; in the order
 * in which they continue alone, then by name. A robot that drives by itself without a path, or has reached its goals, waits for
 * nothing.
 */
export function waitingItems(state: ConsoleState): readonly AttentionItem[] {
  const first = new Map<string, AttentionItem>();
  for (const item of state.attention?.items ?? []) {
    if (item.reason === AttentionReason.REASON_GOALS_REACHED || drivesAlone(state, item)) continue;
    const kept = first.get(item.robot);
    if (kept === undefined || kept.reason === AttentionReason.REASON_FIRST_PATH) {
      first.set(item.robot, item);
    }
  }
  const key = ({ deadline, since, givesUpAfter }: AttentionItem) => {
    if (deadline > 0) return deadline;
    return givesUpAfter > 0 ? since + givesUpAfter : Number.MAX_VALUE;
  };
  return [...first.values()].sort((a, b) => {
    const [sooner, later] = [key(a), key(b)];
    return sooner === later ? byName.compare(a.robot, b.robot) : sooner - later;
  });
}

/** Without a path robots of these methods drive by themselves. */
const aloneMethods: ReadonlySet<string> = new Set(["ig-mcts", "greedy"]);

export function drivesWithoutPath(state: ConsoleState, robot: string): boolean {
  if (!aloneMethods.has(state.session?.method ?? "")) return false;
  const { cellMoves, outcome } = state.robots.get(robot) ?? {};
  return (cellMoves ?? 0n) > 0n || outcome === CommandOutcome.OUTCOME_RUNNING;
}

function drivesAlone(state: ConsoleState, { robot, reason }: AttentionItem): boolean {
  return reason === AttentionReason.REASON_FIRST_PATH && drivesWithoutPath(state, robot);
}

/** The same reason at another time, or with another picture, is another item. */
export function itemKey({ robot, reason, since, newestSnapshot }: AttentionItem): string {
  const picture = reason === AttentionReason.REASON_SNAPSHOT ? newestSnapshot : "";
  return `${robot} ${reason} ${since} ${picture}`;
}

/**
 * The first item that nobody else works on and that is not in `passed`. If all have been visited, starts over, preferring items
 * that I do not work on. Never one of `gone`.
 */
export function nextItem(
  state: ConsoleState,
  passed: ReadonlySet<string>,
  gone: ReadonlySet<string>,
): AttentionItem | undefined {
  const me = state.welcome?.client ?? "";
  const items = waitingItems(state).filter(
    (item) => (item.selectedBy === "" || item.selectedBy === me) && !gone.has(itemKey(item)),
  );
  return (
    items.find((item) => !passed.has(itemKey(item))) ??
    items.find(({ selectedBy }) => selectedBy === "") ??
    items[0]
  );
}

/** Somebody has ordered the robot to stop, or it reports itself that it is stopped. */
export function isStopped(state: ConsoleState, robot: string | undefined): boolean {
  const name = robot ?? "";
  return (state.controls.get(name)?.stopped || state.robots.get(name)?.stopped) ?? false;
}

/** The robot itself reports that it is stopped. */
export function hasStopped(state: ConsoleState, robot: string): boolean {
  return state.robots.get(robot)?.stopped ?? false;
}

export function areAllStopped(state: ConsoleState): boolean {
  const names = robotNames(state);
  return names.length > 0 && names.every((name) => hasStopped(state, name));
}

/** The service keeps the robot's goals, and this page may set them: not those of a robot that keeps them itself. */
export function offersGoals(state: ConsoleState, robot: string | undefined): boolean {
  const named = state.session?.goalRobots.includes(robot ?? "") ?? false;
  return named && mayCommand(state) && state.robots.get(robot ?? "")?.keepsGoals === false;
}

/** All robots are stopped and nobody has control: the session has not started. */
export function waitsForStart(state: ConsoleState): boolean {
  const controls = robotNames(state).map((name) => state.controls.get(name));
  const idle = (control: Control | undefined) => control?.stopped === true && control.holder === "";
  return controls.length > 0 && controls.every(idle) && mayCommand(state);
}

/** Cells of a trail's pieces, in the order in which the robot entered them. */
export function trailCells(trail: ReadonlyMap<number, Trail>): readonly CellAt[] {
  const cells: CellAt[] = [];
  for (const [first, piece] of [...trail].sort(([a], [b]) => a - b)) {
    // A piece may overlap the previous one.
    cells.length = Math.min(first, cells.length);
    cells.push(...piece.cells);
  }
  return cells;
}

export interface Difference {
  /** Missing: walls in the picture that are free on the map. Wrong: the reverse. */
  readonly missing: readonly CellAt[];
  readonly wrong: readonly CellAt[];
}

/** Differences between a picture and the operator's map. */
export function differenceOf(picture: Snapshot, belief: Belief, columns: number): Difference {
  const isWall = (cell: CellAt) => isWallAt(belief.walls, cellIndex({ columns }, cell));
  return {
    missing: cellsOf(picture.wallCells).filter((cell) => !isWall(cell)),
    wrong: cellsOf(picture.freeCells).filter(isWall),
  };
}

export type AlertPlace = "active" | "acknowledged" | "shelved" | "over";

/** `now`: wall time of the service. */
export function placeOf(alert: Alert, now: number): AlertPlace {
  if (!alert.active) return "over";
  if (alert.shelvedUntil > now) return "shelved";
  return alert.acknowledgedBy === "" ? "active" : "acknowledged";
}
