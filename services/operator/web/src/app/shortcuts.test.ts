import { describe, expect, it } from "vitest";
import { commandOf, keyHint, keyOf, keyParts, shortcuts } from "./shortcuts";

const plain = { shiftKey: false, ctrlKey: false, altKey: false, metaKey: false };
const calm = { replay: false, busy: false, onControl: false };
const press = (key: string, more = {}) => ({ ...plain, key, ...more });

describe("shortcuts", () => {
  it("have each key once", () => {
    const keys = shortcuts.flatMap((shortcut) => shortcut.keys);
    expect(new Set(keys).size).toBe(keys.length);
  });

  it("have each command once", () => {
    const commands = shortcuts.map(({ command }) => command);
    expect(new Set(commands).size).toBe(commands.length);
  });

  it("ignore case, but distinguish Shift", () => {
    expect(commandOf(press("g"), calm)).toBe("resume robot");
    expect(commandOf(press("G", { shiftKey: true }), calm)).toBe("resume all");
  });

  it("find punctuation with or without Shift", () => {
    expect(commandOf(press("?", { shiftKey: true }), calm)).toBe("help");
    expect(commandOf(press(".", { shiftKey: true }), calm)).toBe("stop robot");
  });

  it("leave the browser's own keys alone", () => {
    expect(keyOf(press("n", { ctrlKey: true }))).toBeUndefined();
    expect(commandOf(press("s", { metaKey: true }), calm)).toBeUndefined();
  });

  it("do nothing while somebody types, except to stop all", () => {
    const busy = { ...calm, busy: true };
    expect(commandOf(press("n"), busy)).toBeUndefined();
    expect(commandOf(press("Escape", { shiftKey: true }), busy)).toBe("stop all");
  });

  it("stop nothing by Escape alone", () => {
    expect(commandOf(press("Escape"), calm)).toBe("close view");
  });

  it("play recordings only where there is one, and not from a button", () => {
    expect(commandOf(press(" "), calm)).toBeUndefined();
    expect(commandOf(press(" "), { ...calm, replay: true })).toBe("play");
    expect(commandOf(press(" "), { ...calm, replay: true, onControl: true })).toBeUndefined();
  });

  it("are named for people", () => {
    expect(keyParts("Shift+Escape")).toEqual(["Shift", "Esc"]);
    expect(keyParts("+")).toEqual(["+"]);
    expect(keyHint("next")).toBe("N");
  });
});
