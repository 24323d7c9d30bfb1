import { expect, it } from "vitest";
import { shortcuts } from "../../app/shortcuts";
import { inMappingTask, taskKeys } from "./task_keys";

it("N and X both ask for the next picture", () => {
  expect(inMappingTask("next")).toBe("nothing new");
  expect(inMappingTask("nothing new")).toBe("nothing new");
});

it("keys of supervision mean nothing in the mapping task", () => {
  for (const command of ["take control", "acknowledge", "workload", "events"] as const) {
    expect(inMappingTask(command)).toBeUndefined();
  }
  expect(inMappingTask(undefined)).toBeUndefined();
});

it("every key that the task's help names does something there", () => {
  for (const key of taskKeys.flatMap(({ keys }) => keys)) {
    const found = shortcuts.find((shortcut) => shortcut.keys.includes(key));
    expect(inMappingTask(found?.command), key).toBeDefined();
  }
});
