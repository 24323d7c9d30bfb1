import type { ConsoleState } from "../../state/console_state";

/** What the steps of the tour depend on. */
export interface TourState {
  readonly state: ConsoleState;
  readonly chosenRobot: string | undefined;
  /** How often the person selected an item of the queue. */
  readonly selections: number;
}

export interface TourStep {
  readonly key: string;
  readonly title: string;
  readonly text: string;
  /** `data-tour` of the part that it explains. */
  readonly about?: "map" | "queue" | "pictures";
  /** Whether the person has done it since the step started. Without it, a button leads on. */
  done?(before: TourState, now: TourState): boolean;
  /** Whether the button says "Next" rather than "Skip". */
  ready?(now: TourState): boolean;
}

const wrongMap = {
  key: "map",
  title: "Your map is wrong",
  text: "The robots look for their goals in a maze. The map in the middle is yours. Some of its walls do not exist, others are missing. The robots see the truth and send you a picture when it is worth your time.",
  about: "map",
} as const;

const wrongMapSeenLive = {
  ...wrongMap,
  text: "The robots look for their goals in a maze. The map in the middle is yours. Some of its walls do not exist, others are missing. The robots see the truth: watch the live view on the right.",
} as const;

const queue: TourStep = {
  key: "queue",
  title: "Robots that need you",
  text: "The queue on the right lists the robots that need you, and why. The most urgent robot is first. Press N to select it.",
  about: "queue",
  done: (before, now) => now.selections > before.selections,
};

const path: TourStep = {
  key: "path",
  title: "Draw a path",
  text: "Choose the “Path” tool above the map. Drag from the robot to its goals, around the walls. The path is sent when you release.",
  about: "map",
  done: (before, now) => pathsByMe(now.state) > pathsByMe(before.state),
};

const picture: TourStep = {
  key: "picture",
  title: "Look at a picture",
  text: "The robot is on its way. When it finds something that contradicts your map, it sends a picture. The picture appears on the right; the map shows where it was taken. This may take a moment.",
  about: "pictures",
  ready: ({ state }) => state.pictures.size > 0,
};

const liveView: TourStep = {
  key: "live view",
  title: "Look at the live view",
  text: "The robot follows your path. The live view shows what its camera sees. Look for walls that differ from your map.",
  about: "pictures",
};

const drive: TourStep = {
  key: "drive",
  title: "Drive",
  text: "Hold the arrow keys. Up and down drive the chosen robot, left and right turn it. It stops when you release the key. The live view shows what its camera sees.",
  about: "pictures",
  done: (before, now) => stepsOfChosen(now) > stepsOfChosen(before, now.chosenRobot),
};

const wall: TourStep = {
  key: "wall",
  title: "Correct your map",
  text: "Compare the picture with your map. Draw missing walls with the “Wall” tool. Remove wrong ones with “Erase”. If the map is right, press X: nothing new.",
  about: "map",
  done: (before, now) => answersByMe(now.state) > answersByMe(before.state),
};

const wallSeenLive: TourStep = {
  ...wall,
  text: "Compare the live view with your map. Draw missing walls with the “Wall” tool. Remove wrong ones with “Erase”.",
};

const wallBetweenDrives: TourStep = {
  ...wall,
  text: `${wallSeenLive.text} While one of these tools is chosen, the arrow keys move the map's cursor. Press Esc to drive again.`,
};

const another: TourStep = {
  key: "next",
  title: "Keep going",
  text: "The robot waits for a path, or continues alone after a while. Press N whenever a robot needs you.",
  about: "queue",
  done: (before, now) => now.selections > before.selections,
};

const anotherPath: TourStep = {
  ...another,
  text: "Where its path ends or a wall blocks it, the robot stops until you draw another path. Press N whenever a robot needs you.",
};

const end: TourStep = {
  key: "end",
  title: "That is all",
  text: "Shift Esc stops all robots at any time. Press ? for all keys. Good luck!",
};

/** Steps by method. */
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

/** Number of my edits and of pictures that I answered. */
function answersByMe({ beliefs, pictures, welcome }: ConsoleState): number {
  const me = welcome?.client;
  const edits = [...beliefs.values()].filter(({ editedBy }) => editedBy === me);
  const answered = [...pictures.values()].flat().filter(({ answeredBy }) => answeredBy === me);
  return edits.reduce((sum, { revision }) => sum + Number(revision), answered.length);
}

/** Low-level steps that `robot` was driven. */
function stepsOfChosen({ state, chosenRobot }: TourState, robot = chosenRobot): number {
  return Number(state.robots.get(robot ?? "")?.lowLevelSteps ?? 0n);
}
