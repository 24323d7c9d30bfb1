import type {
  ServerMessage,
  Snapshot,
  Trail,
  Update,
  Updates,
  Welcome,
} from "../protocol/generated/console_pb";
import {
  type ConsoleState,
  emptyState,
  type KeyedState,
  mostEvents,
  mostPictures,
} from "./console_state";

/** The state after `message`; the same object if nothing changed. */
export function reduce(state: ConsoleState, message: ServerMessage): ConsoleState {
  const { body } = message;
  switch (body.case) {
    case "welcome":
      return welcomed(state, body.value);
    case "updates":
      return updated(state, body.value);
    case "frame":
      return keyed(state, "frames", body.value.robot, body.value);
    default:
      return state;
  }
}

/** The screen keeps the old data until the service has sent everything again. */
function welcomed(state: ConsoleState, welcome: Welcome): ConsoleState {
  const sequence = welcome.resumed ? state.sequence : 0n;
  return { ...state, welcome, run: welcome.run, sequence };
}

function updated(state: ConsoleState, updates: Updates): ConsoleState {
  const { welcome, run } = state;
  const begin = updates.everything ? { ...emptyState, welcome, run } : state;
  return updates.update.reduce(apply, begin);
}

function apply(state: ConsoleState, update: Update): ConsoleState {
  const next = applyBody(state, update.body);
  return update.sequence > next.sequence ? { ...next, sequence: update.sequence } : next;
}

function applyBody(state: ConsoleState, body: Update["body"]): ConsoleState {
  switch (body.case) {
    case "session":
      return { ...state, session: body.value };
    case "attention":
      return { ...state, attention: body.value };
    case "presence":
      return { ...state, presence: body.value };
    case "playback":
      return { ...state, playback: body.value };
    case "task":
      return { ...state, task: body.value };
    case "form":
      return { ...state, form: body.value };
    case "draft":
      return { ...state, draft: body.value };
    case "studyLog":
      return { ...state, studyLog: body.value };
    case "world":
      return keyed(state, "worlds", body.value.name, body.value);
    case "belief":
      return keyed(state, "beliefs", body.value.world, body.value);
    case "truth":
      return keyed(state, "truths", body.value.world, body.value);
    case "service":
      return keyed(state, "services", body.value.name, body.value);
    case "trail":
      return { ...state, trails: withTrail(state.trails, body.value) };
    case "snapshot":
      return { ...state, pictures: withPicture(state.pictures, body.value) };
    case "alert":
      return { ...state, alerts: inOrder(state.alerts, body.value, ({ id }) => id) };
    case "event":
      return {
        ...state,
        events: inOrder(state.events, body.value, ({ id }) => id).slice(-mostEvents),
      };
    default:
      return applyOfRobot(state, body);
  }
}

function applyOfRobot(state: ConsoleState, body: Update["body"]): ConsoleState {
  switch (body.case) {
    case "robot":
      return keyed(state, "robots", body.value.name, body.value);
    case "seen":
      return keyed(state, "seen", body.value.robot, body.value);
    case "plan":
      return keyed(state, "plans", body.value.robot, body.value);
    case "search":
      return keyed(state, "searches", body.value.robot, body.value);
    case "prediction":
      return keyed(state, "predictions", body.value.robot, body.value);
    case "guidance":
      return keyed(state, "guidance", body.value.robot, body.value);
    case "goalPose":
      return keyed(state, "goalPoses", body.value.robot, body.value);
    case "control":
      return keyed(state, "controls", body.value.robot, body.value);
    default:
      return state;
  }
}

type ValueOf<Slice> = Slice extends ReadonlyMap<string, infer Value> ? Value : never;

function keyed<Name extends keyof KeyedState>(
  state: ConsoleState,
  name: Name,
  key: string,
  value: ValueOf<KeyedState[Name]>,
): ConsoleState {
  const slice: ReadonlyMap<string, unknown> = state[name];
  return { ...state, [name]: new Map(slice).set(key, value) };
}

function withTrail(trails: ConsoleState["trails"], piece: Trail): ConsoleState["trails"] {
  const pieces = new Map(trails.get(piece.robot)).set(piece.first, piece);
  return new Map(trails).set(piece.robot, pieces);
}

function withPicture(
  pictures: ConsoleState["pictures"],
  picture: Snapshot,
): ConsoleState["pictures"] {
  const known = pictures.get(picture.robot) ?? [];
  const all = inOrder(known, picture, ({ sequenceNumber }) => sequenceNumber);
  return new Map(pictures).set(picture.robot, all.slice(-mostPictures));
}

/** Inserts `value` in key order, or replaces the one with its key. Fast for the newest key. */
function inOrder<T>(values: readonly T[], value: T, keyOf: (value: T) => bigint): readonly T[] {
  const key = keyOf(value);
  const after = values.findLastIndex((other) => keyOf(other) <= key);
  const found = values[after];
  const replaced = found !== undefined && keyOf(found) === key;
  return [...values.slice(0, replaced ? after : after + 1), value, ...values.slice(after + 1)];
}
