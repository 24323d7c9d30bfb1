import { type ReadonlySignal, signal } from "@preact/signals";
import type { ConsoleState } from "../../state/console_state";

/** What the steps of the tour look at. */
export interface Sight {
  readonly state: ConsoleState;
  readonly chosenRobot: string | undefined;
  /** How often the person turned to an item of the queue. */
  readonly turns: number;
}

export interface TourStep {
  readonly title: string;
  readonly text: string;
  /** `data-tour` of what it is about. */
  readonly about?: "map" | "queue" | "pictures";
  /** Whether it has happened since the step began; without one the person goes on by a button. */
  done?(before: Sight, now: Sight): boolean;
  /** The button is there when this holds. */
  ready?(now: Sight): boolean;
}

export const tourSteps: readonly TourStep[] = [
  {
    title: "Your map is wrong",
    text: "Robots look for their goals in a maze. Your map of it, in the middle, has walls that are not there, and lacks others. Robots see the truth, and send you a picture when it is worth your time.",
    about: "map",
  },
  {
    title: "Who asks for you?",
    text: "The queue at the right tells who asks, and why; the most urgent comes first. Press N to go to the first.",
    about: "queue",
    done: (before, now) => now.turns > before.turns,
  },
  {
    title: "Draw a path",
    text: "Choose the tool “Path” above the map. Draw from the robot to its goals, around the walls, and send the path.",
    about: "map",
    done: (before, now) => pathsByMe(now.state) > pathsByMe(before.state),
  },
  {
    title: "Look at a picture",
    text: "Now the robot goes. When it sees something that your map has otherwise, it sends a picture. It shows up at the right, and on the map, where it was taken. This may take a moment.",
    about: "pictures",
    ready: ({ state }) => state.pictures.size > 0,
  },
  {
    title: "Mark the wall",
    text: "Compare the picture with your map. Draw missing walls with the tool “Wall”, remove wrong ones with “Erase”. If the map is right, press X: nothing new.",
    about: "map",
    done: (before, now) => answersByMe(now.state) > answersByMe(before.state),
  },
  {
    title: "And the next",
    text: "The robot waits for a path, or goes on alone after a while. Press N whenever somebody asks.",
    about: "queue",
    done: (before, now) => now.turns > before.turns,
  },
  {
    title: "That is all",
    text: "Shift Esc stops all robots, at any time. The key ? shows all keys. Good luck!",
  },
];

function pathsByMe({ guidance, welcome }: ConsoleState): number {
  const mine = [...guidance.values()].filter(({ givenBy }) => givenBy === welcome?.client);
  return mine.reduce((sum, { revision }) => sum + Number(revision), 0);
}

/** Edits count, and pictures that were answered. */
function answersByMe({ beliefs, pictures, welcome }: ConsoleState): number {
  const me = welcome?.client;
  const edits = [...beliefs.values()].filter(({ editedBy }) => editedBy === me);
  const answered = [...pictures.values()].flat().filter(({ answeredBy }) => answeredBy === me);
  return edits.reduce((sum, { revision }) => sum + Number(revision), answered.length);
}

/** A guided first use: each step goes on by what really happens. */
export class Tour {
  readonly #step = signal<number | undefined>(undefined);
  #before: Sight | undefined;

  /** Number of the step; undefined = no tour. */
  get step(): ReadonlySignal<number | undefined> {
    return this.#step;
  }

  begin(now: Sight): void {
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
    const step = tourSteps[this.#step.value ?? -1];
    if (this.#before !== undefined && step?.done?.(this.#before, now)) this.goOn(now);
  }

  #enter(step: number, now: Sight): void {
    this.#before = now;
    this.#step.value = step < tourSteps.length ? step : undefined;
  }
}
