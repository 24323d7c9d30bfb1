import { expect, it } from "vitest";
import { EventKind, MarkKind } from "../../protocol/generated/console_pb";
import { stateOf } from "../../state/fixtures";
import { mark } from "../../state/history";
import { liveMarks } from "./live_marks";
import { linkTo, momentOf } from "./moment_link";

it("marks of a run that goes on are edits, paths, answers, notes, pictures, alerts and goals", () => {
  const { EVENT_EDIT, EVENT_GUIDE, EVENT_ANSWER, EVENT_NOTE, EVENT_STOP } = EventKind;
  const events = [EVENT_EDIT, EVENT_GUIDE, EVENT_ANSWER, EVENT_NOTE, EVENT_STOP].map((kind, i) => ({
    case: "event" as const,
    value: { id: BigInt(i), kind, time: 10 + i, text: `event ${i}` },
  }));
  const state = stateOf(
    ...events,
    { case: "snapshot", value: { robot: "r1", sequenceNumber: 3n, receivedAt: 20 } },
    { case: "alert", value: { id: 1n, source: "sim", text: "silent", raised: 21 } },
  );
  const goal = mark(MarkKind.MARK_GOAL, 22, "r1", "r1 reached goal 1 of 4");
  const kinds = liveMarks(state, [goal]).map(({ kind, position }) => [kind, position]);
  expect(kinds).toEqual([
    [MarkKind.MARK_EDIT, 10],
    [MarkKind.MARK_GUIDANCE, 11],
    [MarkKind.MARK_GUIDANCE, 12],
    [MarkKind.MARK_NOTE, 13],
    [MarkKind.MARK_SNAPSHOT, 20],
    [MarkKind.MARK_ALERT, 21],
    [MarkKind.MARK_GOAL, 22],
  ]);
});

it("a link to a moment names run and time, and replaces what the address had", () => {
  const link = linkTo("http://127.0.0.1:8080/#run=old&moment=1", "a run", 1764150000.52);
  expect(momentOf(new URL(link).hash)).toEqual({ run: "a run", time: 1764150000.5 });
  expect(momentOf("#run=a")).toBeUndefined();
  expect(momentOf("")).toBeUndefined();
});
