import { effect, signal } from "@preact/signals";
import { beforeEach, describe, expect, it } from "vitest";
import { Role } from "../protocol/generated/console_pb";
import { updates, welcomeMessage } from "./fixtures";
import { defaultSettings } from "./settings";
import { computedByValue, createStore, type Store, searchesShown } from "./store";

let store: Store;

beforeEach(() => {
  store = createStore(defaultSettings);
});

describe("commands", () => {
  it("can be given by operators while the link is live", () => {
    store.receive(welcomeMessage());
    expect(store.canCommand.value).toBe(false);
    store.link.value = { state: "live" };
    expect(store.canCommand.value).toBe(true);
    store.receive(welcomeMessage({ role: Role.OBSERVER }));
    expect(store.canCommand.value).toBe(false);
  });
});

it("shows search reports of the chosen robot, of all where the map shows them", () => {
  store.receive(welcomeMessage());
  store.receive(updates(["r1", "r2"].map((name) => ({ case: "robot", value: { name } }))));
  store.settle();
  expect(searchesShown(store)).toEqual(["r1"]);
  store.choose("r2");
  expect(searchesShown(store)).toEqual(["r2"]);
  store.settings.value = { ...defaultSettings, layers: { ...defaultSettings.layers, search: 1 } };
  expect(searchesShown(store)).toEqual(["r1", "r2"]);
});

it("changes only when its content does", () => {
  const source = signal({ row: 1, doing: "idle" });
  const value = computedByValue(() => ({ doing: source.value.doing }));
  const seen: unknown[] = [];
  effect(() => {
    seen.push(value.value);
  });
  source.value = { row: 2, doing: "idle" };
  expect(seen).toEqual([{ doing: "idle" }]);
  source.value = { row: 2, doing: "met a wall" };
  expect(seen).toEqual([{ doing: "idle" }, { doing: "met a wall" }]);
});
