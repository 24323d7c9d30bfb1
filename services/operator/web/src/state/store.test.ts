import { beforeEach, describe, expect, it } from "vitest";
import { Role } from "../protocol/generated/console_pb";
import { welcomeMessage } from "./fixtures";
import { defaultSettings } from "./settings";
import { createStore, type Store } from "./store";

let store: Store;

beforeEach(() => {
  store = createStore(defaultSettings);
});

describe("commands", () => {
  it("can be given by who may, while the link is live", () => {
    store.receive(welcomeMessage());
    expect(store.canCommand.value).toBe(false);
    store.link.value = { state: "live" };
    expect(store.canCommand.value).toBe(true);
    store.receive(welcomeMessage({ role: Role.OBSERVER }));
    expect(store.canCommand.value).toBe(false);
  });
});
