import { type Signal, signal } from "@preact/signals";
import type { Cancel, Clock } from "../../connection/clock";
import type { Link } from "../../connection/connection";
import type { Timing } from "../../connection/timing";
import { DriveAction } from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";
import { freshnessOf } from "../../state/freshness";
import { commandBlockedReason, isStopped } from "../../state/selectors";
import { isTask, mapBlockedReason } from "../task/task_state";

/** Duration of a low-level action, s. */
const drivePeriod = 0.25;

interface TeleoperationParts {
  readonly clock: Clock;
  drive(robot: string, action: DriveAction): void;
  chosenRobot(): string | undefined;
  /** Why the robot cannot be driven now; undefined = it can. */
  blockedReason(robot: string): string | undefined;
  /** A key was pressed that cannot drive. */
  blocked(reason: string): void;
}

/**
 * Driving by hand: sends an action when a key goes down, and again every `drivePeriod` while it is held. Driving ends with one
 * stop: on `release` of the last key, on `halt` (lost focus or page), when another robot is chosen, or when driving gets blocked.
 */
export class Teleoperation {
  /** The current action; undefined = not driving. */
  readonly action: Signal<DriveAction | undefined> = signal(undefined);
  #parts: TeleoperationParts;
  /** Actions of the keys that are down; the newest applies. */
  #held: DriveAction[] = [];
  #robot = "";
  #cancel: Cancel = () => undefined;

  constructor(parts: TeleoperationParts) {
    this.#parts = parts;
  }

  press(action: DriveAction): void {
    if (this.#held.includes(action)) return;
    const robot = this.#parts.chosenRobot();
    if (robot === undefined) return;
    const reason = this.#parts.blockedReason(robot);
    if (reason !== undefined) {
      this.halt();
      this.#parts.blocked(reason);
      return;
    }
    if (robot !== this.#robot) this.halt();
    this.#robot = robot;
    this.#held.push(action);
    this.#restart();
  }

  release(action: DriveAction): void {
    if (!this.#held.includes(action)) return;
    this.#held = this.#held.filter((other) => other !== action);
    if (this.#held.length === 0) this.halt();
    else if (this.action.value === action) this.#restart();
  }

  /** Stops the robot at once if it is driven. */
  halt(): void {
    this.#cancel();
    this.#held = [];
    if (this.action.value === undefined) return;
    this.action.value = undefined;
    this.#parts.drive(this.#robot, DriveAction.DRIVE_STOP);
  }

  #restart(): void {
    this.#cancel();
    this.#send();
    this.#cancel = this.#parts.clock.every(drivePeriod, () => this.#again());
  }

  #again(): void {
    const gone = this.#parts.chosenRobot() !== this.#robot;
    if (gone || this.#parts.blockedReason(this.#robot) !== undefined) this.halt();
    else this.#send();
  }

  #send(): void {
    const action = this.#held.at(-1);
    if (action === undefined) return;
    this.action.value = action;
    this.#parts.drive(this.#robot, action);
  }
}

/** Round trips in s above which driving is advised against or refused; defaults if the service sends none. */
export function driveLimits({ welcome }: Pick<ConsoleState, "welcome">) {
  return {
    advisedAgainst: welcome?.limits?.driveAdvisedAgainst || 0.3,
    refused: welcome?.limits?.driveRefused || 1,
  };
}

/** Why `robot` cannot be driven now; undefined = it can. `now`: wall time of the service. */
export function driveBlockedReason(
  state: ConsoleState,
  link: Link,
  { roundTrip }: Timing,
  now: number | undefined,
  robot: string,
): string | undefined {
  if (!state.session?.drives) return "this method does not drive by hand";
  if (link.state !== "live") return "the connection is not live";
  const forbidden = commandBlockedReason(state, robot);
  if (forbidden !== undefined) return forbidden;
  const begins = isTask(state) ? mapBlockedReason(state) : undefined;
  if (begins !== undefined) return begins;
  if (isStopped(state, robot)) return `${robot} is stopped (G resumes it)`;
  if (!state.robots.has(robot)) return `${robot} has not reported yet`;
  if (freshnessOf(state.robots.get(robot)?.receivedAt, now, true) === "lost")
    return `${robot} is lost`;
  if (roundTrip === undefined) return "the round trip is not measured yet";
  const { refused } = driveLimits(state);
  return roundTrip > refused ? `the round trip is above ${refused} s` : undefined;
}

export function isAdvisedAgainst(state: ConsoleState, { roundTrip }: Timing): boolean {
  return (roundTrip ?? 0) > driveLimits(state).advisedAgainst;
}
