import { computed, type ReadonlySignal } from "@preact/signals";
import {
  type MapProps,
  type MapRobot,
  type Outcome,
  offers,
  type Permission,
} from "../map/map_props";
import { isTask, mapBlockedReason, offersPaths } from "../panels/task/task_state";
import type { CellAt } from "../protocol/cells";
import type { Snapshot } from "../protocol/generated/console_pb";
import type { ConsoleState } from "../state/console_state";
import { freshnessOf } from "../state/freshness";
import {
  commandBlockedReason,
  hasStopped,
  isStopped,
  mayCommand,
  nameOf,
  offersGoals,
  onlyWatches,
  trailCells,
  withNames,
  worldOf,
} from "../state/selectors";
import { computedByValue, type Store } from "../state/store";
import type { Actions } from "./actions";
import { lookOf } from "./palette";

/** The map of the chosen robot's world; undefined while no world is known. */
export function mapView(store: Store, actions: Actions): ReadonlySignal<MapProps | undefined> {
  const { motion: state, linked, chosenRobot } = store;
  const world = computed(() => worldOf(state.value, chosenRobot.value)?.name);
  const names = computed(() => robotsIn(state.value, store.robots.value, world.value));
  const parts = {
    seen: ofRobots(() => state.value.seen, names),
    plans: ofRobots(() => state.value.plans, names),
    searches: ofRobots(() => state.value.searches, names),
    predictions: ofRobots(() => state.value.predictions, names),
    guidance: ofRobots(() => state.value.guidance, names),
    goalPoses: ofRobots(() => state.value.goalPoses, names),
    trails: trailsOf(() => state.value, names),
    pictures: picturesOf(() => state.value.pictures, names),
  };
  const robots = computed(() => mapRobots(store, names.value));
  // The past and a page without a link have the same tools, so that the map keeps its size; they do nothing there.
  const readOnly = computed(() => !mayCommand(store.live.value));
  const mayEdit = computedByValue(() => permission(editBlockedReason(state.value, linked.value)));
  const mayGuide = computedByValue(() =>
    permission(guideBlockedReason(state.value, linked.value, chosenRobot.value)),
  );
  const callbacks = callbacksOf(store, actions);

  return computed(() => {
    const shown = state.value.worlds.get(world.value ?? "");
    return (
      shown && {
        world: shown,
        belief: state.value.beliefs.get(shown.name),
        truth: state.value.truths.get(shown.name),
        robots: robots.value,
        seen: parts.seen.value,
        trails: parts.trails.value,
        plans: parts.plans.value,
        searches: parts.searches.value,
        predictions: parts.predictions.value,
        guidance: parts.guidance.value,
        goalPoses: parts.goalPoses.value,
        pictures: parts.pictures.value,
        chosenPicture: store.chosenPicture.value,
        layers: store.settings.value.layers,
        chosenRobot: chosenRobot.value,
        tool: toolOf(state.value, store.tool.value, chosenRobot.value),
        readOnly: readOnly.value,
        participates: isTask(state.value),
        isPast: state.value.isPast,
        offersPaths: offersPaths(state.value),
        offersGoals: offersGoals(state.value, chosenRobot.value),
        arrowsDrive: state.value.session?.drives === true && mayCommand(state.value),
        mayEdit: mayEdit.value,
        mayGuide: mayGuide.value,
        stopped: isStopped(state.value, chosenRobot.value),
        editLimit: state.value.welcome?.limits?.editCells || undefined,
        accept: store.accept.value,
        focus: store.focus.value,
        ...callbacks,
      }
    );
  });
}

/** The path tool may have been chosen in an earlier part of a study, the goal tool for another robot. */
function toolOf(state: ConsoleState, tool: MapProps["tool"], robot: string | undefined) {
  const offered = {
    offersPaths: offersPaths(state),
    offersGoals: offersGoals(state, robot),
  };
  return offers(offered, tool) ? tool : "look";
}

function callbacksOf(store: Store, actions: Actions) {
  return {
    onLayers: (layers: MapProps["layers"]) => {
      store.settings.value = { ...store.settings.value, layers };
    },
    nameOf: (client: string) => nameOf(store.state.peek(), client),
    onTool: (tool: MapProps["tool"]) => {
      if (tool === "look" || mayCommand(store.state.peek())) store.tool.value = tool;
    },
    onChooseRobot: (name: string) => store.choose(name),
    onEdit: (...edit: Parameters<MapProps["onEdit"]>) => named(store, actions.edit(...edit)),
    onGoals: (...goals: Parameters<MapProps["onGoals"]>) => named(store, actions.goals(...goals)),
    onPath: (...path: Parameters<MapProps["onPath"]>) => named(store, actions.guide(...path)),
  };
}

async function named(store: Store, asked: Promise<Outcome>): Promise<Outcome> {
  const { accepted, reason } = await asked;
  return { accepted, reason: withNames(store.state.peek(), reason) };
}

/** With a single world this returns `all` itself, so that identity comparisons hold. */
function robotsIn(state: ConsoleState, all: readonly string[], world: string | undefined) {
  if (state.worlds.size <= 1) return all;
  return all.filter((name) => state.robots.get(name)?.world === world);
}

/** The entries of `names`; changes only when one of them changes. */
function ofRobots<T>(
  source: () => ReadonlyMap<string, T>,
  names: ReadonlySignal<readonly string[]>,
): ReadonlySignal<ReadonlyMap<string, T>> {
  let kept: ReadonlyMap<string, T> = new Map();
  return computed(() => {
    const all = source();
    const now = new Map([...all].filter(([name]) => names.value.includes(name)));
    const same = now.size === kept.size && [...now].every(([name, v]) => kept.get(name) === v);
    if (!same) kept = now;
    return kept;
  });
}

function trailsOf(state: () => ConsoleState, names: ReadonlySignal<readonly string[]>) {
  const pieces = ofRobots(() => state().trails, names);
  return computed<ReadonlyMap<string, readonly CellAt[]>>(() => {
    const trails = pieces.value;
    return new Map([...trails].map(([name, trail]) => [name, trailCells(trail)]));
  });
}

function picturesOf(
  source: () => ReadonlyMap<string, readonly Snapshot[]>,
  names: ReadonlySignal<readonly string[]>,
) {
  const all = ofRobots(source, names);
  return computed(() => [...all.value.values()].flat());
}

function mapRobots(
  { motion: state, now, linked, robots }: Store,
  names: readonly string[],
): readonly MapRobot[] {
  return names.flatMap((name) => {
    const robot = state.value.robots.get(name);
    if (robot === undefined) return [];
    const fresh = freshnessOf(robot.receivedAt, now.value, linked.value);
    const stopped = hasStopped(state.value, name);
    return [{ robot, fresh, stopped, ...lookOf(robots.value.indexOf(name)) }];
  });
}

function permission(reason: string | undefined): Permission {
  return reason === undefined ? { allowed: true } : { allowed: false, reason };
}

function editBlockedReason(state: ConsoleState, linked: boolean): string | undefined {
  if (!linked) return "the connection is not live";
  if (state.playback !== undefined) return "this is a recording";
  if (state.isPast) return "you are looking at the past";
  if (onlyWatches(state)) return "you are an observer";
  return isTask(state) ? mapBlockedReason(state) : undefined;
}

function guideBlockedReason(
  state: ConsoleState,
  linked: boolean,
  robot: string | undefined,
): string | undefined {
  if (robot === undefined) return "no robot is chosen";
  return editBlockedReason(state, linked) ?? commandBlockedReason(state, robot);
}
