// @vitest-environment happy-dom
import { render } from "preact";
import { act } from "preact/test-utils";
import { beforeEach, expect, it } from "vitest";
import { fakeConsole, InConsole } from "../../app/fixtures";
import { FakeConnection } from "../../connection/fake";
import type { TakeOver } from "../../state/store";
import { TakeOverDialog } from "./take_over_dialog";

const connection = new FakeConnection();

beforeEach(() => {
  connection.asked.length = 0;
  render(null, document.body);
});

function find<T extends Element>(kind: new () => T, selector: string): T {
  const found = document.querySelector(selector);
  if (!(found instanceof kind)) throw new Error(`no ${selector}`);
  return found;
}

const renamed: string[] = [];

async function show(takeOver: TakeOver, name: string): Promise<void> {
  const console = fakeConsole(connection);
  console.store.name.value = name;
  const rename = (given: string) => Promise.resolve(void renamed.push(given));
  await act(() =>
    render(
      <InConsole of={{ ...console, rename }}>
        <TakeOverDialog takeOver={takeOver} />
      </InConsole>,
      document.body,
    ),
  );
}

async function type(text: string): Promise<void> {
  const input = find(HTMLInputElement, "input");
  input.value = text;
  await act(() => void input.dispatchEvent(new Event("input", { bubbles: true })));
}

const submit = () =>
  act(() => void find(HTMLFormElement, "form").dispatchEvent(new Event("submit")));

it("asks those who have control, and takes over at once only with a reason", async () => {
  await show({ robots: ["r1"], from: ["Bo"] }, "Ann");
  expect(document.body.textContent).toContain("Bo has control of r1");
  const over = () => find(HTMLButtonElement, "form button:not([type=submit])");
  expect(over().disabled).toBe(true);
  await type("shift change");
  await act(() => over().click());
  await submit();
  const value = { robots: ["r1"], reason: "shift change" };
  expect(connection.asked).toEqual([
    { case: "takeControl", value },
    { case: "takeControl", value: { ...value, ask: true } },
  ]);
});

it("asks a person without a name for it, once, before control is taken", async () => {
  await show({ robots: ["r1"], from: [] }, "");
  await type("Ann");
  await submit();
  expect(renamed).toEqual(["Ann"]);
  expect(connection.asked).toEqual([
    { case: "takeControl", value: { robots: ["r1"], reason: "" } },
  ]);
});
