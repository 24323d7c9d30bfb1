import { CommandOutcome, type Robot } from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";
import { ageOf, type Freshness, freshnessOf } from "../../state/freshness";
import {
  drivesWithoutPath,
  type Holder,
  hasStopped,
  holderOf,
  isStopped,
  nameOf,
  runTime,
  waitingItems,
} from "../../state/selectors";
import { reasonText } from "../attention/queue_texts";

/** What the fleet strip shows of a robot. */
export interface FleetRow {
  readonly name: string;
  readonly freshness: Freshness | "no data yet";
  /** s since its newest state. */
  readonly age: number | undefined;
  readonly goalsReached: number;
  readonly goalsTotal: number;
  /** Somebody has ordered it to stop, or it reports that it is stopped. */
  readonly stopped: boolean;
  /** Who stopped it and why; undefined = not stopped. */
  readonly stop: string | undefined;
  readonly holder: Holder;
  /** Why it waits for the operator, and for how many s of the run's clock. */
  readonly wait: { readonly why: string; readonly seconds: number } | undefined;
  /** What it does now, in a word: "stopping…" until it reports itself that it is stopped. */
  readonly doing: string;
}

/** `linked`: whether the link is live. */
export function fleetRow(
  state: ConsoleState,
  now: number | undefined,
  linked: boolean,
  name: string,
): FleetRow {
  const robot = state.robots.get(name);
  const item = waitingItems(state).find((one) => one.robot === name);
  return {
    name,
    freshness:
      linked && robot === undefined ? "no data yet" : freshnessOf(robot?.receivedAt, now, linked),
    age: ageOf(robot?.receivedAt, now),
    goalsReached: (robot?.goalsTotal ?? 0) - (robot?.goalsLeft.length ?? 0),
    goalsTotal: robot?.goalsTotal ?? 0,
    stopped: isStopped(state, name),
    stop: stopText(state, name),
    holder: holderOf(state, name),
    wait: item && {
      why: reasonText(item.reason, state.session?.drives ?? false),
      seconds: shownSeconds(runTime(state, now) - item.since),
    },
    doing: isStopped(state, name)
      ? `■ ${hasStopped(state, name) ? "stopped" : "stopping…"}`
      : doingText(robot, !state.guidance.has(name) && drivesWithoutPath(state, name)),
  };
}

/** No finer than people read it, so that a card is not made again for each report. */
function shownSeconds(seconds: number): number {
  return Math.max(0, seconds < 10 ? Math.round(2 * seconds) / 2 : Math.round(seconds));
}

function isDone({ goalsTotal, goalsLeft }: Robot): boolean {
  return goalsTotal > 0 && goalsLeft.length === 0;
}

function stopText(state: ConsoleState, name: string): string | undefined {
  const control = state.controls.get(name);
  if (!isStopped(state, name)) return undefined;
  if (!control?.stopped) return "stopped, by its own report";
  const by = control.stoppedBy === "" ? "" : ` by ${nameOf(state, control.stoppedBy)}`;
  return `stopped${by}${control.stopReason === "" ? "" : `: ${control.stopReason}`}`;
}

function doingText(robot: Robot | undefined, withoutPath: boolean): string {
  if (robot === undefined) return "";
  if (isDone(robot)) return "✓ all goals reached";
  switch (robot.outcome) {
    case CommandOutcome.OUTCOME_RUNNING:
      return withoutPath ? "driving without a path" : "driving";
    case CommandOutcome.OUTCOME_BLOCKED:
      return "blocked by a wall";
    case CommandOutcome.OUTCOME_OCCUPIED:
      return "giving way";
    case CommandOutcome.OUTCOME_REFUSED:
      return "command refused";
    case CommandOutcome.OUTCOME_EXPIRED:
      return "command expired";
    case CommandOutcome.OUTCOME_STOPPED:
      return "waits for a command";
    default:
      return "idle";
  }
}

/** Who has control. `recorded`: recordings do not contain it, because control is not on the bus. */
export function controlText({ holder, name }: FleetRow, recorded: boolean): string {
  switch (holder.kind) {
    case "me":
      return `You have control of ${name}`;
    case "other":
      return `${holder.name} has control of ${name}: ${holder.reason || "no reason given"}`;
    default:
      return recorded
        ? `The recording does not say who had control of ${name}`
        : `Nobody has control of ${name}`;
  }
}
