import type { Clock } from "../../connection/clock";

export interface Place {
  /** s since the beginning of the recording. */
  readonly position?: number;
  /** Recorded seconds per second; 0 = pause. */
  readonly speed?: number;
}

/** s between two requests: a slider that is dragged asks more often than the service takes. */
export const seekPeriod = 0.1;

/** Asks for places in a recording: the first at once, of those that follow quickly the newest. */
export class Seeker {
  #seek: (to: Place) => void;
  #clock: Clock;
  #next: Place | undefined;
  #resting = false;

  constructor(seek: (to: Place) => void, clock: Clock) {
    this.#seek = seek;
    this.#clock = clock;
  }

  seek(to: Place): void {
    this.#next = { ...this.#next, ...to };
    if (!this.#resting) this.#ask();
  }

  #ask(): void {
    const to = this.#next;
    this.#next = undefined;
    this.#resting = to !== undefined;
    if (to === undefined) return;
    this.#seek(to);
    this.#clock.after(seekPeriod, () => this.#ask());
  }
}
