import type { ConsoleState } from "../../state/console_state";

/** What the steps of the tour look at. */
export interface TourState {
  readonly state: ConsoleState;
  readonly chosenRobot: string | undefined;
  /** How often the person turned to an item of the queue. */
  readonly selections: number;
}

export interface TourStep {
  readonly title: string;
  readonly text: string;
  /** `data-tour` of what it is about. */
  readonly about?: "map" | "queue" | "pictures";
  /** Whether it has happened since the step began; without one the person goes on by a button. */
  done?(before: TourState, now: TourState): boolean;
  /** The button is there when this holds. */
  ready?(now: TourState): boolean;
}

const wrongMap = {
  title: "Your map is wrong",
  text: "Robots look for their goals in a maze. Your map of it, in the middle, has walls that are not there, and lacks others. Robots see the truth, and send you a picture when it is worth your time.",
  about: "map",
} as const;

const wrongMapSeenLive = {
  ...wrongMap,
  text: "Robots look for their goals in a maze. Your map of it, in the middle, has walls that are not there, and lacks others. Robots see the truth: the live view at the right shows it.",
} as const;

const queue: TourStep = {
  title: "Who asks for you?",
  text: "The queue at the right tells who asks, and why; the most urgent comes first. Press N to go to the first.",
  about: "queue",
  done: (before, now) => now.selections > before.selections,
};

const path: TourStep = {
  title: "Draw a path",
  text: "Choose the tool “Path” above the map. Draw from the robot to its goals, around the walls, and send the path.",
  about: "map",
  done: (before, now) => pathsByMe(now.state) > pathsByMe(before.state),
};

const picture: TourStep = {
  title: "Look at a picture",
  text: "Now the robot goes. When it sees something that your map has otherwise, it sends a picture. It shows up at the right, and on the map, where it was taken. This may take a moment.",
  about: "pictures",
  ready: ({ state }) => state.pictures.size > 0,
};

const liveView: TourStep = {
  title: "Look at the live view",
  text: "Now the robot goes your path. The live view shows what its camera sees: look for walls that your map has otherwise.",
  about: "pictures",
};

const drive: TourStep = {
  title: "Drive",
  text: "Hold the arrow keys: up and down drive the chosen robot, left and right turn it. It stands when you let go. The live view shows what its camera sees.",
  about: "pictures",
  done: (before, now) => stepsOfChosen(now) > stepsOfChosen(before, now.chosenRobot),
};

const wall: TourStep = {
  title: "Mark the wall",
  text: "Compare the picture with your map. Draw missing walls with the tool “Wall”, remove wrong ones with “Erase”. If the map is right, press X: nothing new.",
  about: "map",
  done: (before, now) => answersByMe(now.state) > answersByMe(before.state),
};

const wallSeenLive: TourStep = {
  ...wall,
  text: "Compare the live view with your map. Draw missing walls with the tool “Wall”, remove wrong ones with “Erase”.",
};

const wallBetweenDrives: TourStep = {
  ...wall,
  text: `${wallSeenLive.text} While such a tool is chosen the arrow keys are the map's; Esc lets them drive again.`,
};

const another: TourStep = {
  title: "And the next",
  text: "The robot waits for a path, or goes on alone after a while. Press N whenever somebody asks.",
  about: "queue",
  done: (before, now) => now.selections > before.selections,
};

const anotherPath: TourStep = {
  ...another,
  text: "The robot stops where its path ends or a wall is in the way, until you draw another one. Press N whenever somebody asks.",
};

const end: TourStep = {
  title: "That is all",
  text: "Shift Esc stops all robots, at any time. The key ? shows all keys. Good luck!",
};

/** By method. */
const steps: ReadonlyMap<string, readonly TourStep[]> = new Map([
  ["instruction", [wrongMapSeenLive, queue, path, liveView, wallSeenLive, anotherPath, end]],
  ["teleop", [wrongMapSeenLive, queue, drive, wallBetweenDrives, end]],
]);
const usual: readonly TourStep[] = [wrongMap, queue, path, picture, wall, another, end];

export function tourSteps(method: string): readonly TourStep[] {
  return steps.get(method) ?? usual;
}

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

/** How far `robot` was driven. */
function stepsOfChosen({ state, chosenRobot }: TourState, robot = chosenRobot): number {
  return Number(state.robots.get(robot ?? "")?.lowLevelSteps ?? 0n);
}
