import { effect } from "@preact/signals";
import { beforeEach, expect, it } from "vitest";
import { FakeClock } from "../connection/fake";
import { updates } from "./fixtures";
import { Inbox } from "./inbox";
import { defaultSettings } from "./settings";
import { createStore, type Store } from "./store";

let clock: FakeClock;
let store: Store;
let inbox: Inbox;
let shown: number[];
let calls: number;

const robot = (x: number) => updates([{ case: "robot", value: { name: "r1", x } }]);

beforeEach(() => {
  clock = new FakeClock();
  store = createStore(defaultSettings);
  calls = 0;
  inbox = new Inbox(store, clock, () => {
    calls += 1;
  });
  shown = [];
  effect(() => {
    const found = store.motion.value.robots.get("r1");
    if (found) shown.push(found.x);
  });
});

it("shows the first message at once, and those that follow quickly together", () => {
  inbox.receive(robot(1));
  inbox.receive(robot(2));
  inbox.receive(robot(3));
  expect(shown).toEqual([1]);
  clock.advance(0.03);
  expect(shown).toEqual([1, 3]);
});

it("shows at once again after a pause", () => {
  inbox.receive(robot(1));
  clock.advance(1);
  inbox.receive(robot(2));
  expect(shown).toEqual([1, 2]);
});

it("can be emptied before its time, and then shows nothing twice", () => {
  inbox.receive(robot(1));
  inbox.receive(robot(2));
  inbox.empty();
  clock.advance(1);
  expect(shown).toEqual([1, 2]);
});

it("calls back each time when all messages are shown", () => {
  inbox.receive(robot(1));
  expect(calls).toBe(1);
  inbox.receive(robot(2));
  inbox.receive(robot(3));
  expect(calls).toBe(1);
  clock.advance(1);
  expect(calls).toBe(2);
});
