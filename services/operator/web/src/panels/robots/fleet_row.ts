import { CommandOutcome, type Robot } from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";
import { ageOf, type Freshness, freshnessOf } from "../../state/freshness";
import { type Holder, holderOf, itemsOf, nameOf } from "../../state/selectors";
import { isNotice, reasonText } from "../attention/queue_texts";

/** What the fleet strip tells of a robot. */
export interface FleetRow {
  readonly name: string;
  readonly freshness: Freshness | "not heard yet";
  /** s since the newest news of it. */
  readonly age: number | undefined;
  readonly goalsReached: number;
  readonly goalsTotal: number;
  readonly stopped: boolean;
  /** Who stopped it, and why; undefined = it is not stopped. */
  readonly stop: string | undefined;
  readonly holder: Holder;
  /** That it waits for the operator: why, and since how many s of the operator's time. */
  readonly wait: { readonly why: string; readonly seconds: number } | undefined;
  /** What it does otherwise, in a word. */
  readonly doing: string;
}

/** `linked`: whether the service is heard now. */
export function fleetRow(
  state: ConsoleState,
  now: number | undefined,
  linked: boolean,
  name: string,
): FleetRow {
  const robot = state.robots.get(name);
  const item = itemsOf(state, name).find(({ reason }) => !isNotice(reason));
  return {
    name,
    freshness:
      linked && robot === undefined ? "not heard yet" : freshnessOf(robot?.heardAt, now, linked),
    age: ageOf(robot?.heardAt, now),
    goalsReached: (robot?.goalsTotal ?? 0) - (robot?.goalsLeft.length ?? 0),
    goalsTotal: robot?.goalsTotal ?? 0,
    stopped: state.controls.get(name)?.stopped ?? false,
    stop: stopText(state, name),
    holder: holderOf(state, name),
    wait: item && {
      why: reasonText(item.reason, state.session?.drives ?? false),
      seconds: Math.max(0, (state.attention?.stamp ?? item.since) - item.since),
    },
    doing: doingText(robot),
  };
}

function isDone({ goalsTotal, goalsLeft }: Robot): boolean {
  return goalsTotal > 0 && goalsLeft.length === 0;
}

function stopText(state: ConsoleState, name: string): string | undefined {
  const control = state.controls.get(name);
  if (!control?.stopped) return undefined;
  const by = control.stoppedBy === "" ? "" : ` by ${nameOf(state, control.stoppedBy)}`;
  return `stopped${by}${control.stopReason === "" ? "" : `: ${control.stopReason}`}`;
}

function doingText(robot: Robot | undefined): string {
  if (robot === undefined) return "";
  if (isDone(robot)) return "✓ all goals reached";
  switch (robot.outcome) {
    case CommandOutcome.OUTCOME_RUNNING:
      return "on its way";
    case CommandOutcome.OUTCOME_BLOCKED:
      return "met a wall";
    case CommandOutcome.OUTCOME_OCCUPIED:
      return "makes way";
    case CommandOutcome.OUTCOME_REFUSED:
      return "command refused";
    case CommandOutcome.OUTCOME_EXPIRED:
      return "command expired";
    default:
      return "stands";
  }
}

/** Who has control. `recorded`: the run is one of before; leases of control are not on the bus, so not in its recording. */
export function controlText({ holder, name }: FleetRow, recorded: boolean): string {
  switch (holder.kind) {
    case "me":
      return `You have control of ${name}`;
    case "other":
      return `${holder.name} has control of ${name}: ${holder.reason || "no reason given"}`;
    default:
      return recorded
        ? `Who had control of ${name} is not in the recording`
        : `Nobody has control of ${name}`;
  }
}
