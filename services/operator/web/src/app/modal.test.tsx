// @vitest-environment happy-dom
import { render } from "preact";
import { act } from "preact/test-utils";
import { beforeEach, describe, expect, it } from "vitest";
import type { Console } from "./console";
import { fakeConsole, InConsole } from "./fixtures";
import { Modal } from "./modal";

let console: Console;

const show = (title: string) =>
  act(() =>
    render(
      <InConsole of={console}>
        <Modal key={title} title={title}>
          Text
        </Modal>
      </InConsole>,
      document.body,
    ),
  );
const dialog = () => document.querySelector("dialog");

beforeEach(async () => {
  document.body.replaceChildren();
  console = fakeConsole();
  console.store.dialog.value = { kind: "help" };
  await show("one");
});

describe("a dialog", () => {
  it("that the browser closes, as by Esc, is closed for the page too", async () => {
    await act(() => dialog()?.close());
    expect(console.store.dialog.value).toBeUndefined();
  });

  it("that gives way to another one does not close that", async () => {
    const first = dialog();
    await show("two");
    await act(() => void first?.dispatchEvent(new Event("close")));
    expect(console.store.dialog.value).toEqual({ kind: "help" });
  });
});
