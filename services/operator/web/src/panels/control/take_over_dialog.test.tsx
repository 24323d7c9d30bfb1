// @vitest-environment happy-dom
import { signal } from "@preact/signals";
import { render } from "preact";
import { act } from "preact/test-utils";
import { beforeEach, expect, it } from "vitest";
import { Actions } from "../../app/actions";
import { commandsOf } from "../../app/commands";
import { type Console, ConsoleContext } from "../../app/console";
import { FakeClock, FakeConnection } from "../../connection/fake";
import { defaultSettings } from "../../state/settings";
import { createStore } from "../../state/store";
import { Pixels } from "../pictures/pixels";
import { Teleoperation } from "../teleoperation/teleoperation";
import { Tour } from "../tour/tour";
import { emptyHistory } from "../workload/history";
import { TakeOverDialog } from "./take_over_dialog";

const connection = new FakeConnection();

function consoleWith(): Console {
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
    rename: nothing,
    teleoperation: new Teleoperation({
      clock,
      drive: nothing,
      chosenRobot: nothing,
      whyNot: nothing,
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

beforeEach(() => {
  connection.asked.length = 0;
  document.body.innerHTML = "";
});

function find<T extends Element>(kind: new () => T, selector: string): T {
  const found = document.querySelector(selector);
  if (!(found instanceof kind)) throw new Error(`no ${selector}`);
  return found;
}

it("takes control only with a reason, which is sent along", async () => {
  const takeOver = { robots: ["r1"], from: ["Bo"] };
  await act(() =>
    render(
      <ConsoleContext.Provider value={consoleWith()}>
        <TakeOverDialog takeOver={takeOver} />
      </ConsoleContext.Provider>,
      document.body,
    ),
  );
  expect(document.body.textContent).toContain("Bo has control of r1");
  expect(find(HTMLButtonElement, "button.main").disabled).toBe(true);

  const input = find(HTMLInputElement, "input");
  input.value = "shift change";
  await act(() => void input.dispatchEvent(new Event("input", { bubbles: true })));
  expect(find(HTMLButtonElement, "button.main").disabled).toBe(false);

  await act(() => void find(HTMLFormElement, "form").dispatchEvent(new Event("submit")));
  expect(connection.asked).toEqual([
    { case: "takeControl", value: { robots: ["r1"], reason: "shift change" } },
  ]);
});
