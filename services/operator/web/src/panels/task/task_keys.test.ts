import { expect, it } from "vitest";
import { shortcuts } from "../../app/shortcuts";
import { Mode, Role } from "../../protocol/generated/console_pb";
import { emptyState } from "../../state/console_state";
import { updates, welcomeMessage } from "../../state/fixtures";
import { reduce } from "../../state/reduce";
import { inTask, nextPictureKey, nothingNewKey, taskKeys, themeKey } from "./task_keys";

const inMode = (mode: Mode) => reduce(emptyState, welcomeMessage({ mode }));
const mapping = inMode(Mode.MAPPING_TASK);
const study = inMode(Mode.STUDY);

it("N and X both ask for the next picture of the mapping task", () => {
  expect(inTask(mapping, "next")).toBe("nothing new");
  expect(inTask(mapping, "nothing new")).toBe("nothing new");
});

it("X answers a picture in a study, N does nothing there", () => {
  expect(inTask(study, "nothing new")).toBe("nothing new");
  expect(inTask(study, "next")).toBeUndefined();
});

it("keys of supervision mean nothing to participants", () => {
  for (const command of ["take control", "acknowledge", "workload", "events"] as const) {
    expect(inTask(mapping, command)).toBeUndefined();
    expect(inTask(study, command)).toBeUndefined();
    expect(inTask(inMode(Mode.SUPERVISE), command)).toBe(command);
  }
  expect(inTask(mapping, undefined)).toBeUndefined();
});

it("with several robots N goes on to the next one that needs the participant", () => {
  const several = reduce(
    study,
    updates([{ case: "session", value: { robots: ["r1", "r2"], method: "ig-mcts" } }]),
  );
  expect(inTask(several, "next")).toBe("next");
  expect(inTask(several, "next robot")).toBe("next robot");
  expect(inTask(study, "next robot")).toBeUndefined();
});

it("an experimenter's keys command nothing, nor do a participant's while the step is paused", () => {
  const led = reduce(emptyState, welcomeMessage({ mode: Mode.STUDY, role: Role.EXPERIMENTER }));
  expect(inTask(led, "stop all")).toBe("stop all");
  expect(inTask(led, "resume all")).toBeUndefined();
  const paused = reduce(study, updates([{ case: "task", value: { paused: true } }]));
  expect(inTask(paused, "resume all")).toBeUndefined();
  expect(inTask(paused, "stop all")).toBe("stop all");
});

it("every key that the help for participants names does something there", () => {
  const commandOf = (key: string) => shortcuts.find(({ keys }) => keys.includes(key))?.command;
  for (const key of [...taskKeys, nextPictureKey].flatMap(({ keys }) => keys)) {
    expect(inTask(mapping, commandOf(key)), key).toBeDefined();
  }
  for (const key of [...taskKeys, nothingNewKey].flatMap(({ keys }) => keys)) {
    expect(inTask(study, commandOf(key)) === undefined, key).toBe(key === themeKey);
  }
});
