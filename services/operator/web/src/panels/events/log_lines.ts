import { type Event, EventKind } from "../../protocol/generated/console_pb";

/** A line of the command log: an event, or refusals of the same request one after the other. */
export interface LogLine {
  /** The newest of them. */
  readonly event: Event;
  readonly times: number;
  /** Wall time of the oldest. */
  readonly since: number;
}

/** s between two refusals that still count as one after the other. */
const mostApart = 60;

/** Newest first. `events`: oldest first. */
export function logLines(events: readonly Event[]): readonly LogLine[] {
  // In the order in which they got their newest event.
  const lines = new Map<string, LogLine>();
  for (const event of events) {
    const key = sameness(event);
    const before = lines.get(key);
    lines.delete(key);
    const goesOn = before !== undefined && event.time - before.event.time <= mostApart;
    if (before !== undefined && !goesOn) lines.set(String(before.event.id), before);
    const times = goesOn ? before.times + 1 : 1;
    lines.set(key, { event, times, since: goesOn ? before.since : event.time });
  }
  return [...lines.values()].sort((a, b) => Number(b.event.id - a.event.id));
}

/** Equal for repeated refusals; how many cells it was about does not matter. */
function sameness({ kind, id, client, robot, world, text }: Event): string {
  if (kind !== EventKind.EVENT_REFUSED) return String(id);
  return [client, world, robot, text.replace(/\d+ cells?/, "cells")].join("\n");
}
