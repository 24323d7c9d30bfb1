// @vitest-environment happy-dom
import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { FakeClock, FakeConnection } from "../connection/fake";
import { Teleoperation } from "../panels/robots/teleoperation";
import { DriveAction, Mode } from "../protocol/generated/console_pb";
import { updates, welcomeMessage } from "../state/fixtures";
import { defaultSettings } from "../state/settings";
import { createStore, type Store } from "../state/store";
import { Actions } from "./actions";
import { commandsOf } from "./commands";
import { listenToKeys } from "./keyboard";
import { stopForEditing } from "./wire";

let store: Store;
let connection: FakeConnection;
let driven: DriveAction[];
let unlisten: () => void;

afterEach(() => unlisten());

beforeEach(() => {
  document.body.innerHTML =
    '<button id="b"><span id="in-b"></span></button><input id="i"><input type="checkbox" id="c"><canvas id="map" tabindex="0"></canvas>';
  store = createStore(defaultSettings);
  connection = new FakeConnection();
  driven = [];
  const clock = new FakeClock();
  const actions = new Actions(store, connection, clock);
  const driving = new Teleoperation({
    clock,
    drive: (_robot, action) => driven.push(action),
    chosenRobot: () => store.chosenRobot.value,
    blockedReason: () => undefined,
    blocked: () => undefined,
  });
  stopForEditing(store, driving);
  unlisten = listenToKeys(window, store, commandsOf(store, actions), driving);
  store.receive(welcomeMessage());
  session(true);
});

function session(drives: boolean): void {
  store.receive(updates([{ case: "session", value: { robots: ["r1", "r2"], drives } }]));
}

function press(key: string, more: KeyboardEventInit = {}, id?: string): KeyboardEvent {
  const event = new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true, ...more });
  (id === undefined ? document.body : document.querySelector(`#${id}`))?.dispatchEvent(event);
  return event;
}

describe("keys", () => {
  it("stop all by Shift and Escape, also from a field and with a dialog open", () => {
    store.dialog.value = { kind: "help" };
    press("Escape", { shiftKey: true }, "i");
    expect(connection.asked).toMatchObject([{ case: "stop", value: { robots: [] } }]);
  });

  it("stop the chosen robot only", () => {
    press(".");
    expect(connection.asked).toMatchObject([{ case: "stop", value: { robots: ["r1"] } }]);
  });

  it("write into fields", () => {
    expect(press("s", {}, "i").defaultPrevented).toBe(false);
    expect(connection.asked).toEqual([]);
  });

  it("mean the same with the focus on a box that is ticked", () => {
    press("s", {}, "c");
    expect(connection.asked).toMatchObject([{ case: "stop", value: { robots: ["r1"] } }]);
  });

  it("ask once while they are held", () => {
    press("g");
    press("g", { repeat: true });
    expect(connection.asked).toHaveLength(1);
  });

  it("that the map has dealt with do nothing else", () => {
    const map = document.querySelector("#map");
    map?.addEventListener("keydown", (event) => event.preventDefault());
    press("ArrowUp", {}, "map");
    press("s", {}, "map");
    expect(driven).toEqual([]);
    expect(connection.asked).toEqual([]);
  });

  it("that lead to what asks next lead to the map, unless something has the focus", () => {
    press("j");
    expect(document.activeElement).toBe(document.body);
    press("n");
    expect(document.activeElement?.id).toBe("map");
    document.querySelector<HTMLElement>("#b")?.focus();
    press("n");
    expect(document.activeElement?.id).toBe("b");
  });

  it("never stop everybody when nobody is chosen", () => {
    store.choose(undefined);
    press("s");
    expect(connection.asked).toEqual([]);
  });
});

describe("Space in a recording", () => {
  const play = () => connection.sought.length;

  beforeEach(() => {
    store.receive(welcomeMessage({ mode: Mode.REPLAY }));
    store.receive(updates([{ case: "playback", value: { duration: 10 } }]));
  });

  it("plays it", () => {
    press(" ");
    expect(connection.sought).toEqual([{ speed: 1 }]);
  });

  it("is left to a button that has the focus, also to what is in it", () => {
    press(" ", {}, "b");
    press(" ", {}, "in-b");
    expect(play()).toBe(0);
    press(" ", {}, "map");
    expect(play()).toBe(1);
  });

  it("does nothing where nothing is recorded", () => {
    store.receive(welcomeMessage({ mode: Mode.SUPERVISE }));
    press(" ");
    expect(play()).toBe(0);
  });
});

describe("driving keys", () => {
  const { DRIVE_FORWARD: forward, DRIVE_STOP: stop } = DriveAction;

  it("drive while held and stop when released", () => {
    expect(press("ArrowUp").defaultPrevented).toBe(true);
    window.dispatchEvent(new KeyboardEvent("keyup", { key: "ArrowUp" }));
    expect(driven).toEqual([forward, stop]);
  });

  it("stop when the window loses the focus", () => {
    press("ArrowUp");
    window.dispatchEvent(new Event("blur"));
    expect(driven).toEqual([forward, stop]);
  });

  it("stop when the page is hidden", () => {
    press("ArrowUp");
    Object.defineProperty(document, "hidden", { value: true, configurable: true });
    document.dispatchEvent(new Event("visibilitychange"));
    Object.defineProperty(document, "hidden", { value: false, configurable: true });
    expect(driven).toEqual([forward, stop]);
  });

  it("stop when they are released in a field", () => {
    press("ArrowUp");
    const up = new KeyboardEvent("keyup", { key: "ArrowUp", bubbles: true });
    document.querySelector("#i")?.dispatchEvent(up);
    expect(driven).toEqual([forward, stop]);
  });

  it("do not begin again by repeating while they are still held", () => {
    press("ArrowUp");
    window.dispatchEvent(new Event("blur"));
    expect(press("ArrowUp", { repeat: true }).defaultPrevented).toBe(true);
    expect(driven).toEqual([forward, stop]);
  });

  it("stop with the key also when it writes something else by then", () => {
    press("ArrowUp", { code: "Numpad8" });
    window.dispatchEvent(new KeyboardEvent("keyup", { key: "8", code: "Numpad8" }));
    expect(driven).toEqual([forward, stop]);
  });

  it("go on while another key for the same is held", () => {
    press("ArrowUp", { code: "ArrowUp" });
    press("ArrowUp", { code: "Numpad8" });
    window.dispatchEvent(new KeyboardEvent("keyup", { key: "ArrowUp", code: "Numpad8" }));
    expect(driven).toEqual([forward]);
    window.dispatchEvent(new KeyboardEvent("keyup", { key: "ArrowUp", code: "ArrowUp" }));
    expect(driven).toEqual([forward, stop]);
  });

  it.each([
    [
      "a context menu",
      () => document.body.dispatchEvent(new Event("contextmenu", { bubbles: true })),
    ],
    [
      "something that is dragged",
      () => document.body.dispatchEvent(new Event("dragstart", { bubbles: true })),
    ],
    ["Meta", () => press("Meta", { metaKey: true })],
    ["Control", () => press("Control", { ctrlKey: true })],
    ["Alt", () => press("Alt", { altKey: true })],
  ])("stop at %s, which may swallow the release", (_, happens) => {
    press("ArrowUp");
    happens();
    expect(driven).toEqual([forward, stop]);
  });

  it("are the map's while a tool that edits is chosen, and what they began ends with it", () => {
    press("ArrowUp");
    store.tool.value = "wall";
    expect(driven).toEqual([forward, stop]);
    expect(press("ArrowUp").defaultPrevented).toBe(false);
    expect(driven).toEqual([forward, stop]);
    store.tool.value = "look";
    press("ArrowUp");
    expect(driven).toEqual([forward, stop, forward]);
  });

  it("do nothing in other methods, in fields and behind dialogs", () => {
    press("ArrowUp", {}, "i");
    store.dialog.value = { kind: "help" };
    press("ArrowUp");
    store.dialog.value = undefined;
    session(false);
    press("ArrowUp");
    expect(driven).toEqual([]);
  });
});
