// A console without a service, for component tests.
import { signal } from "@preact/signals";
import type { ComponentChildren } from "preact";
import { FakeClock, FakeConnection } from "../connection/fake";
import { Tour } from "../panels/guide/tour";
import { Pixels } from "../panels/pictures/pixels";
import { Teleoperation } from "../panels/robots/teleoperation";
import { emptyHistory } from "../panels/status/workload_history";
import { defaultSettings } from "../state/settings";
import { createStore } from "../state/store";
import { Actions } from "./actions";
import { commandsOf } from "./commands";
import { type Console, ConsoleContext } from "./console";

export function fakeConsole(connection = new FakeConnection()): Console {
  const clock = new FakeClock();
  const store = createStore(defaultSettings);
  const actions = new Actions(store, connection, clock);
  const nothing = () => undefined;
  return {
    store,
    actions,
    commands: commandsOf(store, actions),
    tour: new Tour(),
    history: signal(emptyHistory),
    rename: () => Promise.resolve(),
    teleoperation: new Teleoperation({
      clock,
      drive: nothing,
      chosenRobot: nothing,
      blockedReason: nothing,
      blocked: nothing,
    }),
    pixels: new Pixels({
      token: "",
      fetch: () => Promise.reject(new Error("no pictures here")),
      createUrl: () => "",
      revokeUrl: nothing,
    }),
  };
}

export function InConsole({ of, children }: { of: Console; children: ComponentChildren }) {
  return <ConsoleContext.Provider value={of}>{children}</ConsoleContext.Provider>;
}
