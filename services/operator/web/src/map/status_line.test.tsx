// @vitest-environment happy-dom
import { signal } from "@preact/signals";
import { render } from "preact";
import { act } from "preact/test-utils";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import type { Note } from "./map_model";
import { NoteLine } from "./status_line";

const note = signal<Note | undefined>(undefined);
const say = (text: string, number: number) =>
  act(() => {
    note.value = { text, number };
  });
const shown = () => document.querySelector(".map-note span");

beforeEach(async () => {
  vi.useFakeTimers();
  note.value = undefined;
  await act(() => render(<NoteLine note={note} />, document.body));
});

afterEach(() => vi.useRealTimers());

describe("a note", () => {
  it("goes after a while, counted from when it was said last", async () => {
    await say("Not now", 1);
    vi.advanceTimersByTime(6000);
    await say("Not now", 2);
    vi.advanceTimersByTime(6000);
    expect(note.value?.text).toBe("Not now");
    vi.advanceTimersByTime(6000);
    expect(note.value).toBeUndefined();
  });

  it("that is said again is another element, which is read aloud again", async () => {
    await say("Not now", 1);
    const before = shown();
    await say("Not now", 2);
    expect(shown()?.textContent).toBe("Not now");
    expect(shown()).not.toBe(before);
  });
});
