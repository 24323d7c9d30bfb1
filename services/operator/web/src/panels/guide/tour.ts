import { type ReadonlySignal, signal } from "@preact/signals";
import type { Store } from "../../state/store";
import { type TourState, type TourStep, tourSteps } from "./tour_steps";

/** A guided first use. Each step ends when the person has really done it. */
export class Tour {
  readonly #step = signal<number | undefined>(undefined);
  #steps: readonly TourStep[] = [];
  #before: TourState | undefined;

  /** Number of the step; undefined = no tour. */
  get step(): ReadonlySignal<number | undefined> {
    return this.#step;
  }

  /** Steps of the method that was in use at the start. */
  get steps(): readonly TourStep[] {
    return this.#steps;
  }

  begin(now: TourState): void {
    this.#steps = tourSteps(now.state.session?.method ?? "");
    this.#enter(0, now);
  }

  /** The person pressed the button. After the last step the tour ends. */
  goOn(now: TourState): void {
    const step = this.#step.value;
    if (step !== undefined) this.#enter(step + 1, now);
  }

  leave(): void {
    this.#step.value = undefined;
  }

  /** Checks whether the step is done. */
  look(now: TourState): void {
    const step = this.#steps[this.#step.value ?? -1];
    if (this.#before !== undefined && step?.done?.(this.#before, now)) this.goOn(now);
  }

  #enter(step: number, now: TourState): void {
    this.#before = now;
    this.#step.value = step < this.#steps.length ? step : undefined;
  }
}

export function tourStateOf({ state, chosenRobot, selections }: Store): TourState {
  return { state: state.value, chosenRobot: chosenRobot.value, selections: selections.value };
}
