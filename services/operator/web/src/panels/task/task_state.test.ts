import { describe, expect, it } from "vitest";
import {
  Mode,
  Role,
  SnapshotAnswer,
  TaskKind,
  TaskPhase,
} from "../../protocol/generated/console_pb";
import { emptyState } from "../../state/console_state";
import { type UpdateBody, updates, welcomeMessage } from "../../state/fixtures";
import { reduce } from "../../state/reduce";
import {
  calmTimeText,
  goalsText,
  hasLiveView,
  isBetweenMazes,
  isExperimenter,
  isMappingTask,
  isMaze,
  isTask,
  mapBlockedReason,
  offersPaths,
  partName,
  resultText,
  robotNow,
  stepStateText,
  stepTitle,
  taskAnnouncements,
  timeLeft,
  timeUsed,
} from "./task_state";

const waiting = { number: 1, count: 3, phase: TaskPhase.PHASE_WAITING, goalsLeft: 4 };
const running = { ...waiting, phase: TaskPhase.PHASE_RUNNING };
const finished = {
  ...running,
  phase: TaskPhase.PHASE_FINISHED,
  showScores: true,
  goalsLeft: 0,
  mappingAccuracy: 0.734,
};

const task = (value: object): UpdateBody => ({ case: "task", value });
const picture = (sequenceNumber: bigint, answer = SnapshotAnswer.ANSWER_NONE): UpdateBody => ({
  case: "snapshot",
  value: { robot: "r1", sequenceNumber, answer },
});
const session: UpdateBody = { case: "session", value: { robots: ["r1"] } };

function inTask(...bodies: UpdateBody[]) {
  const welcomed = reduce(emptyState, welcomeMessage({ mode: Mode.MAPPING_TASK }));
  return reduce(welcomed, updates([session, ...bodies]));
}

function taskOf(value: object) {
  const { task: found } = inTask(task(value));
  if (found === undefined) throw new Error("no task");
  return found;
}

describe("the mapping task", () => {
  it("is known from the Welcome", () => {
    expect(isMappingTask(inTask())).toBe(true);
    expect(isMappingTask(reduce(emptyState, welcomeMessage()))).toBe(false);
  });

  it("allows edits from its beginning to its end only", () => {
    expect(mapBlockedReason(inTask())).toBeDefined();
    expect(mapBlockedReason(inTask(task(waiting)))).toBeDefined();
    expect(mapBlockedReason(inTask(task(running)))).toBeUndefined();
    expect(mapBlockedReason(inTask(task(finished)))).toContain("maze");
  });

  it("is between two mazes when one is finished, and only in its own mode", () => {
    expect(isBetweenMazes(inTask(task(running)))).toBe(false);
    expect(isBetweenMazes(inTask(task(finished)))).toBe(true);
    const supervised = reduce(reduce(emptyState, welcomeMessage()), updates([task(finished)]));
    expect(isBetweenMazes(supervised)).toBe(false);
  });
});

describe("a study", () => {
  const inStudy = (method: string, drives: boolean) =>
    reduce(
      reduce(emptyState, welcomeMessage({ mode: Mode.STUDY })),
      updates([{ case: "session", value: { robots: ["r1"], method, drives } }, task(finished)]),
    );

  it("offers paths in methods that follow them, the mapping task none", () => {
    expect(offersPaths(inStudy("ig-mcts", false))).toBe(true);
    expect(offersPaths(inStudy("teleop", true))).toBe(false);
    expect(offersPaths(inTask())).toBe(false);
    expect(offersPaths(reduce(emptyState, welcomeMessage()))).toBe(true);
    const driving = updates([{ case: "session", value: { drives: true } }]);
    expect(offersPaths(reduce(reduce(emptyState, welcomeMessage()), driving))).toBe(false);
  });

  it("has a live view in methods that stream", () => {
    expect(hasLiveView(inStudy("ig-mcts", false))).toBe(false);
    expect(hasLiveView(inStudy("instruction", false))).toBe(true);
    expect(hasLiveView(inStudy("teleop", true))).toBe(true);
    expect(hasLiveView(inTask())).toBe(false);
  });

  it("has parts instead of mazes, and is between them, too", () => {
    const state = inStudy("ig-mcts", false);
    expect(partName(state)).toBe("Part");
    expect(isBetweenMazes(state)).toBe(true);
    expect(isMappingTask(state)).toBe(false);
    expect(isTask(state) && isTask(inTask())).toBe(true);
    expect(mapBlockedReason(state)).toContain("part");
  });
});

describe("the robot of the mapping task", () => {
  it("drives until its picture has arrived, then waits for the participant", () => {
    expect(robotNow(inTask(), "r1")).toBe("driving");
    expect(robotNow(inTask(picture(1n)), "r1")).toBe("waiting for you");
    const answered = picture(1n, SnapshotAnswer.ANSWER_NOTHING_NEW);
    expect(robotNow(inTask(answered), "r1")).toBe("driving");
  });

  it("is stopped, whatever else", () => {
    const stopped: UpdateBody = { case: "control", value: { robot: "r1", stopped: true } };
    expect(robotNow(inTask(stopped, picture(1n)), "r1")).toBe("stopped");
  });
});

describe("texts", () => {
  it("say how many goals are left, and when the participant may finish", () => {
    expect(goalsText(taskOf(running))).toMatch(/^4 goals/);
    expect(goalsText(taskOf({ ...running, goalsLeft: 1 }))).toMatch(/^1 goal /);
    expect(goalsText(taskOf({ ...running, goalsLeft: 0, mayFinish: true }))).toMatch(/finish/i);
  });

  it("say the result, and whether there is a next maze", () => {
    expect(resultText(taskOf(finished), "Maze")).toMatch(/^Maze 1 .* 73 % .*next/);
    expect(resultText(taskOf({ ...finished, number: 3 }), "Part")).not.toMatch(/next/);
  });
});

describe("a step", () => {
  it("has the title of the protocol, or its number", () => {
    expect(stepTitle(inTask(task({ ...running, title: "A questionnaire" })))).toBe(
      "A questionnaire",
    );
    expect(stepTitle(inTask(task(running)))).toBe("Maze 1 of 3");
  });

  it("says no score where none is to be seen", () => {
    const text = resultText(taskOf({ ...finished, showScores: false }), "Part");
    expect(text).toContain("Part 1 is finished");
    expect(text).not.toMatch(/%/);
    expect(resultText(taskOf({ ...finished, title: "Part 2" }), "Part")).toMatch(/^Part 2 is/);
  });

  it("stands while it is paused, and its map with it", () => {
    const paused = taskOf({ ...running, timeLimit: 60, used: 20, paused: true });
    expect(timeLeft(paused, 5000)).toBe(40);
    expect(stepStateText(paused)).toBe("paused");
    expect(mapBlockedReason(inTask(task(paused)))).toContain("paused");
  });

  it("has a clock that runs on from what was used before", () => {
    const ticking = taskOf({ ...running, timeLimit: 60, used: 20, since: 1000 });
    expect(timeUsed(ticking, 1010)).toBe(30);
    expect(timeLeft(ticking, 1010)).toBe(30);
    expect(timeLeft(ticking, 2000)).toBe(0);
    expect(timeLeft(taskOf(running), 1010)).toBeUndefined();
  });

  it("says its time in minutes, which seldom change", () => {
    expect([30, 61, 120].map(calmTimeText)).toEqual([
      "Less than a minute left",
      "2 minutes left",
      "2 minutes left",
    ]);
  });

  it("is a maze, or has no map", () => {
    expect(isMaze(taskOf(running))).toBe(true);
    expect(isMaze(taskOf({ kind: TaskKind.TASK_FORM }))).toBe(false);
    expect(isMaze(taskOf({ kind: TaskKind.TASK_REST }))).toBe(false);
  });

  it("is led by the page that has the role", () => {
    const led = reduce(emptyState, welcomeMessage({ mode: Mode.STUDY, role: Role.EXPERIMENTER }));
    expect(isExperimenter(led)).toBe(true);
    expect(isExperimenter(inTask())).toBe(false);
  });
});

describe("announcements", () => {
  const texts = (before: UpdateBody[], after: UpdateBody[]) =>
    taskAnnouncements(inTask(...before), inTask(...after)).map(({ text }) => text);

  it("are new pictures, and the right to finish", () => {
    expect(texts([task(running)], [task(running), picture(1n)])).toEqual([
      expect.stringMatching(/picture.* 1/i),
    ]);
    const ready = { ...running, goalsLeft: 0, mayFinish: true };
    expect(texts([task(running)], [task(ready)])[0]).toBe(goalsText(taskOf(ready)));
    expect(texts([task(running)], [task(finished)])[0]).toContain("73 %");
  });

  it("are none without a change, at the beginning, and when the next maze starts", () => {
    expect(texts([task(running), picture(1n)], [task(running), picture(1n)])).toEqual([]);
    expect(texts([], [task(running), picture(1n)])).toEqual([]);
    const next = reduce(inTask(task(finished)), welcomeMessage({ run: "run-2" }));
    expect(taskAnnouncements(inTask(task(running)), next)).toEqual([]);
  });
});
