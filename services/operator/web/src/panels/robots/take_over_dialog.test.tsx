// @vitest-environment happy-dom
import { render } from "preact";
import { act } from "preact/test-utils";
import { beforeEach, expect, it } from "vitest";
import { fakeConsole, InConsole } from "../../app/fixtures";
import { FakeConnection } from "../../connection/fake";
import { TakeOverDialog } from "./take_over_dialog";

const connection = new FakeConnection();

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
      <InConsole of={fakeConsole(connection)}>
        <TakeOverDialog takeOver={takeOver} />
      </InConsole>,
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
