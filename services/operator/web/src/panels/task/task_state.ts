import { Mode, type Task, TaskPhase } from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";
import { pictureOf, unanswered } from "../../state/selectors";
import type { News } from "../announcements/announcer";
import { count, percent } from "../format";

/** Whether a participant of the mapping task sits here. */
export function isMappingTask({ welcome }: ConsoleState): boolean {
  return welcome?.mode === Mode.MAPPING_TASK;
}

/** Finished, and the service of the next maze, if there is one, is not there yet. */
export function isBetweenMazes(state: ConsoleState): boolean {
  return isMappingTask(state) && state.task?.phase === TaskPhase.PHASE_FINISHED;
}

/** Why the participant may not edit the map now; undefined = they may. */
export function whyNotMap({ task }: ConsoleState): string | undefined {
  switch (task?.phase) {
    case TaskPhase.PHASE_RUNNING:
      return undefined;
    case TaskPhase.PHASE_FINISHED:
      return "this maze is finished";
    default:
      return "begin first";
  }
}

/** What the robot is about, for whoever asks for pictures. */
export type RobotNow = "stopped" | "driving" | "waiting for you";

export function robotNow(state: ConsoleState, robot: string | undefined): RobotNow {
  if (state.controls.get(robot ?? "")?.stopped) return "stopped";
  return unanswered(state, robot) === undefined ? "driving" : "waiting for you";
}

/** "2 goals to go", or what may be done without. */
export function goalsText({ goalsLeft, mayFinish }: Task): string {
  if (goalsLeft > 0) return `${count(goalsLeft, "goal")} to go`;
  return mayFinish ? "All goals reached: finish, or ask for more pictures." : "All goals reached";
}

/** How the maze went, and what comes next. */
export function resultText({ mappingAccuracy, number, count: mazes }: Task): string {
  const done = `Maze ${number} is finished: ${percent(mappingAccuracy)} of its mistakes corrected.`;
  const next =
    number < mazes
      ? "The next maze is being prepared…"
      : "That was the last one. Thank you! You can close this page.";
  return `${done} ${next}`;
}

/** For screen readers: what came up between two states. */
export function taskNews(before: ConsoleState, after: ConsoleState): readonly News[] {
  if (before.run !== after.run || before.task === undefined || after.task === undefined) return [];
  const robot = after.session?.robots[0];
  const picture = pictureOf(after, robot);
  const texts = [
    picture !== undefined && pictureOf(before, robot)?.sequenceNumber !== picture.sequenceNumber
      ? `Picture ${picture.sequenceNumber} has come`
      : "",
    after.task.mayFinish && !before.task.mayFinish ? goalsText(after.task) : "",
    isBetweenMazes(after) && !isBetweenMazes(before) ? resultText(after.task) : "",
  ];
  return texts.filter((text) => text !== "").map((text) => ({ text, urgent: false }));
}
