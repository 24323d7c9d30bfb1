import { type ReadonlySignal, signal } from "@preact/signals";
import type { Store } from "../../state/store";
import { type Sight, type TourStep, tourSteps } from "./tour_steps";

/** A guided first use: each step goes on by what really happens. */
export class Tour {
  readonly #step = signal<number | undefined>(undefined);
  #steps: readonly TourStep[] = [];
  #before: Sight | undefined;

  /** Number of the step; undefined = no tour. */
  get step(): ReadonlySignal<number | undefined> {
    return this.#step;
  }

  /** Those of the method that there was when it began. */
  get steps(): readonly TourStep[] {
    return this.#steps;
  }

  begin(now: Sight): void {
    this.#steps = tourSteps(now.state.session?.method ?? "");
    this.#enter(0, now);
  }

  /** By the button; the last step ends the tour. */
  goOn(now: Sight): void {
    const step = this.#step.value;
    if (step !== undefined) this.#enter(step + 1, now);
  }

  leave(): void {
    this.#step.value = undefined;
  }

  /** Something happened. */
  look(now: Sight): void {
    const step = this.#steps[this.#step.value ?? -1];
    if (this.#before !== undefined && step?.done?.(this.#before, now)) this.goOn(now);
  }

  #enter(step: number, now: Sight): void {
    this.#before = now;
    this.#step.value = step < this.#steps.length ? step : undefined;
  }
}

export function sightOf({ state, chosenRobot, turns }: Store): Sight {
  return { state: state.value, chosenRobot: chosenRobot.value, turns: turns.value };
}
