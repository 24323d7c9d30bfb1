import { type Signal, signal } from "@preact/signals";
import type { Cancel, Clock } from "../../connection/clock";
import { DriveAction } from "../../protocol/generated/console_pb";

/** One low-level action takes so long, s. */
const drivePeriod = 0.25;

export interface TeleoperationParts {
  readonly clock: Clock;
  drive(robot: string, action: DriveAction): void;
  chosenRobot(): string | undefined;
  /** Why nobody may drive it now, in words; undefined = one may. */
  whyNot(robot: string): string | undefined;
  /** A key was pressed in vain. */
  blocked(reason: string): void;
}

/**
 * Driving by hand: sends an action when a key goes down, and again each `drivePeriod` while it is held. Whatever ends the
 * holding ends the driving, with one stop: `release` of the last key, `halt` (focus or page lost), another chosen robot, or a
 * reason that comes up meanwhile.
 */
export class Teleoperation {
  /** What is being driven; undefined = nothing. */
  readonly action: Signal<DriveAction | undefined> = signal(undefined);
  #parts: TeleoperationParts;
  /** Keys that are down; the newest counts. */
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
    const reason = this.#parts.whyNot(robot);
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

  /** Stops at once, if anything is driven. */
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
    if (gone || this.#parts.whyNot(this.#robot) !== undefined) this.halt();
    else this.#send();
  }

  #send(): void {
    const action = this.#held.at(-1);
    if (action === undefined) return;
    this.action.value = action;
    this.#parts.drive(this.#robot, action);
  }
}
