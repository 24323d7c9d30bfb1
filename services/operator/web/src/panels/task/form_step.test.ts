import { create } from "@bufbuild/protobuf";
import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { TaskSchema } from "../../protocol/generated/console_pb";
import { answersOf, draftOfTab, makeDrafts } from "./form_step";

beforeEach(() => {
  vi.useFakeTimers();
});
afterEach(() => {
  vi.useRealTimers();
});

it("a draft goes to the service when the typing pauses, once", () => {
  const sent: string[] = [];
  const { drafts } = makeDrafts((json) => sent.push(json));
  drafts.change({ age: 4 });
  vi.advanceTimersByTime(100);
  drafts.change({ age: 41 });
  expect(sent).toEqual([]);
  vi.advanceTimersByTime(5000);
  expect(sent).toEqual(['{"age":41}']);
});

it("a long text is kept while it is typed", () => {
  const sent: string[] = [];
  const { drafts } = makeDrafts((json) => sent.push(json));
  for (let letters = 1; letters <= 20; letters += 1) {
    drafts.change({ comment: "x".repeat(letters) });
    vi.advanceTimersByTime(100);
  }
  expect(sent.length).toBeGreaterThan(3);
});

it("the tab keeps what the service has not taken", async () => {
  const items = new Map<string, string>();
  const storage = {
    getItem: (key: string) => items.get(key) ?? null,
    setItem: (key: string, value: string) => void items.set(key, value),
  };
  const tab = draftOfTab(storage, create(TaskSchema, { participant: "P01", step: "consent" }));
  await tab.keepUntil(Promise.resolve({ accepted: false, reason: "away" }), '{"age":4}');
  expect(tab.read()).toBe('{"age":4}');
  const other = draftOfTab(storage, create(TaskSchema, { participant: "P02", step: "consent" }));
  expect(other.read()).toBeUndefined();
  const taken = { accepted: true, reason: "" };
  let take = () => {};
  const slow = new Promise<typeof taken>((resolve) => {
    take = () => resolve(taken);
  });
  const first = tab.keepUntil(slow, '{"age":41}');
  await tab.keepUntil(Promise.resolve({ accepted: false, reason: "away" }), '{"age":42}');
  take();
  await first;
  expect(tab.read()).toBe('{"age":42}');
  await tab.keepUntil(Promise.resolve(taken), '{"age":42}');
  expect(tab.read()).toBeUndefined();
});

it("a page that is left sends what waits, one that has sent its answers nothing", () => {
  const sent: string[] = [];
  const { drafts, flush } = makeDrafts((json) => sent.push(json));
  drafts.change({ age: 41 });
  flush();
  flush();
  expect(sent).toEqual(['{"age":41}']);
  drafts.change({ age: 42 });
  drafts.forget();
  vi.advanceTimersByTime(5000);
  expect(sent).toHaveLength(1);
});

it("answers are an object, also where there are none", () => {
  expect(answersOf('{"age":41}')).toEqual({ age: 41 });
  expect([undefined, "", "null", "3"].map(answersOf)).toEqual([{}, {}, {}, {}]);
});
