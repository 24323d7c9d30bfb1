import { Mode, Role, type Task, TaskKind, TaskPhase } from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";
import { isStopped, pictureOf, unanswered } from "../../state/selectors";
import type { Announcement } from "../attention/announcer";
import { count, percent } from "../format";

/** Whether this is the page of a participant in the mapping task. */
export function isMappingTask({ welcome }: ConsoleState): boolean {
  return welcome?.mode === Mode.MAPPING_TASK;
}

/** Whether this is the page of a participant in a study. */
export function isStudy({ welcome }: ConsoleState): boolean {
  return welcome?.mode === Mode.STUDY;
}

/** Whether this is the page of a participant in either. */
export function isTask(state: ConsoleState): boolean {
  return isMappingTask(state) || isStudy(state);
}

/** Whether this page leads a study: it shows what the participant sees, and how they get on. */
export function isExperimenter({ welcome }: ConsoleState): boolean {
  return welcome?.role === Role.EXPERIMENTER;
}

/** Whether the step has a map and robots. */
export function isMaze({ kind }: Task): boolean {
  return kind === TaskKind.TASK_MAPPING || kind === TaskKind.TASK_STUDY;
}

export function hasSeveralRobots({ session }: ConsoleState): boolean {
  return (session?.robots.length ?? 0) > 1;
}

/** The step's title, or "Maze 1 of 3". */
export function stepTitle(state: ConsoleState): string {
  const { task } = state;
  if (task === undefined) return "";
  return task.title || `${partName(state)} ${task.number} of ${task.count}`;
}

/** s that are left of a step with a time limit; undefined without one. `now`: wall time of the service. */
export function timeLeft(task: Task, now: number | undefined): number | undefined {
  if (task.timeLimit === 0) return undefined;
  return Math.max(0, task.timeLimit - timeUsed(task, now));
}

/** s of the step so far, without pauses. */
export function timeUsed({ used, since }: Task, now: number | undefined): number {
  return used + (since > 0 && now !== undefined ? Math.max(0, now - since) : 0);
}

/** In whole minutes: a text that changes each second would draw the eye. */
export function calmTimeText(seconds: number): string {
  const minutes = Math.ceil(seconds / 60);
  return minutes > 1 ? `${minutes} minutes left` : "Less than a minute left";
}

/** Whether the robot follows paths that the person draws. */
export function offersPaths(state: ConsoleState): boolean {
  return !isMappingTask(state) && !state.session?.drives;
}

/** Whether there is a live view. Methods that stream have one even before their first frame. */
export function hasLiveView(state: ConsoleState): boolean {
  const { method = "", streams = false } = state.session ?? {};
  return streams || (isStudy(state) && (method === "instruction" || method === "teleop"));
}

/** "Maze" of a mapping task, "Part" of a study. */
export function partName(state: ConsoleState): string {
  return isStudy(state) ? "Part" : "Maze";
}

/** The maze is finished and the service of the next one, if any, has not started. */
export function isBetweenMazes(state: ConsoleState): boolean {
  return isTask(state) && state.task?.phase === TaskPhase.PHASE_FINISHED;
}

/** Why the participant cannot edit the map now; undefined = they can. */
export function mapBlockedReason(state: ConsoleState): string | undefined {
  if (state.task?.paused) return "this step is paused";
  switch (state.task?.phase) {
    case TaskPhase.PHASE_RUNNING:
      return undefined;
    case TaskPhase.PHASE_FINISHED:
      return `this ${partName(state).toLowerCase()} is finished`;
    default:
      return "press “Begin” first";
  }
}

/** What the robot does, for a participant who waits for pictures. */
export type RobotNow = "stopped" | "driving" | "waiting for you";

export function robotNow(state: ConsoleState, robot: string | undefined): RobotNow {
  if (isStopped(state, robot)) return "stopped";
  return unanswered(state, robot) === undefined ? "driving" : "waiting for you";
}

/** "2 goals left", or that the participant may finish. */
export function goalsText({ goalsLeft, mayFinish }: Task): string {
  if (goalsLeft > 0) return `${count(goalsLeft, "goal")} left`;
  return mayFinish ? "All goals reached. Finish, or continue." : "All goals reached";
}

/** The result of a maze where it is shown, and what comes next. */
export function resultText(task: Task, part: string): string {
  const { showScores, mappingAccuracy, number, title } = task;
  const share =
    showScores && isMaze(task)
      ? `: ${percent(mappingAccuracy)} of the map's mistakes corrected`
      : "";
  return `${title || `${part} ${number}`} is finished${share}. ${nextText(task)}`;
}

/** What comes after a finished step, without saying what it is. */
export function nextText({ number, count: all, aborted }: Task): string {
  if (aborted) return "This part has ended. Please wait.";
  return number < all
    ? "Preparing the next one…"
    : "That was the last one. Thank you! You can close this page.";
}

/** Announcements for screen readers: changes between two states. */
export function taskAnnouncements(
  before: ConsoleState,
  after: ConsoleState,
): readonly Announcement[] {
  if (before.run !== after.run || before.task === undefined || after.task === undefined) return [];
  const robot = after.session?.robots[0];
  const picture = pictureOf(after, robot);
  const texts = [
    picture !== undefined && pictureOf(before, robot)?.sequenceNumber !== picture.sequenceNumber
      ? `New picture: ${picture.sequenceNumber}`
      : "",
    after.task.mayFinish && !before.task.mayFinish ? goalsText(after.task) : "",
    isBetweenMazes(after) && !isBetweenMazes(before) ? resultText(after.task, partName(after)) : "",
  ];
  return texts.filter((text) => text !== "").map((text) => ({ text, urgent: false }));
}

/** How the step stands, for the experimenter. */
export function stepStateText({ phase, paused, aborted }: Task): string {
  if (phase === TaskPhase.PHASE_FINISHED) return aborted ? "aborted" : "finished";
  if (paused) return "paused";
  return phase === TaskPhase.PHASE_RUNNING ? "running" : "waiting";
}
