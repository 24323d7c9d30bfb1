// @vitest-environment happy-dom
import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { at, FakePage } from "./fixtures";
import { attachKeyboard } from "./keyboard_input";
import { MapModel } from "./map_model";
import type { MapProps, Tool } from "./map_props";
import { mapShortcuts, toolKeys } from "./shortcuts";
import { ToolDriver } from "./tool_driver";

let canvas: HTMLCanvasElement;
let page: FakePage;
let model: MapModel;
let detach: () => void = () => {};
let panKey: { held: boolean; used: boolean };

function begin(more: Partial<MapProps> = {}): void {
  detach();
  page = new FakePage(more);
  model = new MapModel(page.props);
  model.resize(800, 600);
  panKey = { held: false, used: false };
  detach = attachKeyboard(canvas, model, new ToolDriver(model), panKey);
}

function press(key: string, more: KeyboardEventInit = {}, target: Element = canvas): boolean {
  const event = new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true, ...more });
  target.dispatchEvent(event);
  target.dispatchEvent(new KeyboardEvent("keyup", { key, bubbles: true, ...more }));
  return event.defaultPrevented;
}

beforeEach(() => {
  canvas = document.createElement("canvas");
  document.body.append(canvas);
  begin();
});

afterEach(() => {
  detach();
  document.body.replaceChildren();
});

describe("arrow keys that drive", () => {
  it("are left alone, however the map got the focus", () => {
    begin({ arrowsDrive: true });
    expect(press("ArrowUp")).toBe(false);
    canvas.dispatchEvent(new Event("pointerdown"));
    canvas.dispatchEvent(new Event("blur"));
    expect(press("ArrowUp")).toBe(false);
    expect(model.cursor.value).toBeUndefined();
  });

  it("move the cursor while a tool that edits is chosen", () => {
    begin({ arrowsDrive: true, tool: "wall" });
    canvas.dispatchEvent(new Event("pointerdown"));
    expect(press("ArrowUp")).toBe(true);
    expect(model.cursor.value).toEqual(at(1, 1));
  });

  it("move the map with Shift", () => {
    begin({ arrowsDrive: true });
    expect(press("ArrowUp", { shiftKey: true })).toBe(true);
  });
});

describe("the key that pans", () => {
  it("uses the tool at the next press, however the pointer panned before", () => {
    begin({ tool: "wall" });
    press("ArrowRight");
    panKey.used = true; // by a drag without it, or one whose key was released elsewhere
    press(" ");
    expect(page.asked).toMatchObject([{ kind: "edit" }]);
  });

  it("uses no tool when it panned", () => {
    begin({ tool: "wall" });
    press("ArrowRight");
    const key = { key: " ", bubbles: true };
    canvas.dispatchEvent(new KeyboardEvent("keydown", key));
    panKey.used = true;
    canvas.dispatchEvent(new KeyboardEvent("keydown", { ...key, repeat: true }));
    canvas.dispatchEvent(new KeyboardEvent("keyup", key));
    expect(page.asked).toEqual([]);
  });
});

describe("the cell cursor", () => {
  it("begins at the chosen robot, moves by arrows, and stays in the grid", () => {
    press("ArrowRight");
    expect(model.cursor.value).toEqual(at(1, 1));
    press("ArrowRight");
    expect(model.cursor.value).toEqual(at(1, 2));
    for (const key of ["ArrowUp", "ArrowUp", "ArrowUp"]) press(key);
    expect(model.cursor.value).toEqual(at(0, 2));
  });

  it("goes to the ends of the row, with Ctrl of the map", () => {
    press("ArrowRight");
    press("End");
    expect(model.cursor.value).toEqual(at(1, 6));
    press("Home", { ctrlKey: true });
    expect(model.cursor.value).toEqual(at(0, 0));
    press("End", { ctrlKey: true });
    expect(model.cursor.value).toEqual(at(4, 6));
  });

  it("Shift with an arrow moves the map instead", () => {
    const before = model.view.value;
    press("ArrowRight", { shiftKey: true });
    expect(model.cursor.value).toBeUndefined();
    expect(model.view.value?.x).toBeLessThan(before?.x ?? 0);
  });
});

describe("the tools by keys alone", () => {
  it("Space draws a wall at the cursor, and Ctrl+Z waits to take it back", () => {
    begin({ tool: "wall" });
    for (const key of ["ArrowRight", "ArrowRight", " "]) press(key);
    expect(page.asked).toMatchObject([{ kind: "edit", cells: [{ cell: at(1, 2), wall: true }] }]);
    expect(press("z", { ctrlKey: true })).toBe(true);
    expect(model.editing.value?.queue).toEqual([{ kind: "undo" }]);
  });

  it("Space held while the pointer pans draws nothing", () => {
    begin({ tool: "wall" });
    press("ArrowRight");
    canvas.dispatchEvent(new KeyboardEvent("keydown", { key: " ", cancelable: true }));
    panKey.used = true;
    canvas.dispatchEvent(new KeyboardEvent("keyup", { key: " " }));
    expect(page.asked).toEqual([]);
  });

  it("Space makes a path, Delete shortens it, Enter sends it, Escape leaves it", () => {
    begin({ tool: "path" });
    for (const key of ["ArrowRight", "ArrowRight", " ", "ArrowRight", " "]) press(key);
    press("ArrowLeft");
    press("Enter");
    expect(page.asked).toMatchObject([
      { kind: "path", cells: [at(1, 1), at(1, 2), at(1, 3)], robot: "r1" },
    ]);
    begin({ tool: "path" });
    for (const key of ["End", "End", " ", "Delete", "Enter"]) press(key);
    expect(page.asked).toEqual([]);
  });

  it("Enter on a robot chooses it", () => {
    begin({ tool: "look", chosenRobot: "r2" });
    press("ArrowUp");
    press("Enter");
    expect(page.asked).toEqual([{ kind: "robot", name: "r2" }]);
  });
});

describe("keys of the whole page", () => {
  it("choose the tools, wherever the focus is", () => {
    expect(press("o", {}, document.body)).toBe(false);
    begin({ offersGoals: true });
    for (const [key, tool] of toolKeys) {
      expect(press(key, {}, document.body)).toBe(true);
      expect(page.asked.at(-1)).toEqual({ kind: "tool", tool });
    }
  });

  it("leave text fields, dialogs and Stop's Shift+Escape alone", () => {
    const field = document.createElement("input");
    document.body.append(field);
    expect(press("w", {}, field)).toBe(false);
    expect(press("Escape", { shiftKey: true }, document.body)).toBe(false);
    const dialog = document.createElement("dialog");
    dialog.setAttribute("open", "");
    document.body.append(dialog);
    expect(press("w", {}, document.body)).toBe(false);
    expect(page.asked).toEqual([]);
  });

  it("Escape puts the tool down; with nothing to leave it is the page's", () => {
    begin({ tool: "erase" });
    expect(press("Escape", {}, document.body)).toBe(true);
    expect(page.asked).toEqual([{ kind: "tool", tool: "look" satisfies Tool }]);
    begin({ tool: "look" });
    expect(press("Escape", {}, document.body)).toBe(false);
  });

  it("zoom", () => {
    const scale = model.view.value?.scale ?? 0;
    press("+", {}, document.body);
    press("+", {}, document.body);
    const near = model.view.value?.scale ?? 0;
    expect(near).toBeGreaterThan(scale);
    press("-", {}, document.body);
    expect(model.view.value?.scale).toBeLessThan(near);
    press("0", {}, document.body);
    expect(model.view.value?.scale).toBe(scale);
  });
});

it("the help lists the key of every tool", () => {
  const listed = mapShortcuts.flatMap(({ keys }) => keys.map((key) => key.toLowerCase()));
  expect(listed).toEqual(expect.arrayContaining([...toolKeys.keys()]));
});
