import { useComputed } from "@preact/signals";
import { useConsole } from "../../app/console";
import { type Event, EventKind } from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";
import { nameOf, withNames } from "../../state/selectors";
import { timeOfDay } from "../format";
import "./status.css";

const mostShown = 200;

/** Who sent which command, newest first. */
export function Events() {
  const { store } = useConsole();
  const state = store.state.value;
  const events = useComputed(() => store.state.value.events);
  const shown = useComputed(() => logLines(events.value).slice(0, mostShown)).value;
  return (
    <section class="panel events" aria-label="Command log">
      <h2>Command log</h2>
      {shown.length === 0 && <p class="quiet">No commands yet.</p>}
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: keyboard users scroll it. */}
      <ol tabIndex={0}>
        {shown.map(({ event, times, since }) => (
          <li key={String(event.id)} class={event.kind === EventKind.EVENT_REFUSED ? "warn" : ""}>
            <time class="quiet">{timeOfDay(event.time)}</time>{" "}
            <strong>{nameOf(state, event.client)}</strong> {textOf(state, event)}
            {times > 1 && (
              <span class="quiet">
                {" "}
                ({times} times since {timeOfDay(since)})
              </span>
            )}
          </li>
        ))}
      </ol>
    </section>
  );
}

function textOf(state: ConsoleState, { text: raw, robot, world }: Event): string {
  const about = robot || world;
  const text = withNames(state, raw);
  return about === "" || text.includes(about) ? text : `${about}: ${text}`;
}

/** A line of the command log: an event, or repeated refusals of the same request. */
interface LogLine {
  /** The newest of them. */
  readonly event: Event;
  readonly times: number;
  /** Wall time of the oldest. */
  readonly since: number;
}

/** s; refusals closer than this are folded into one line. */
const mostApart = 60;

/** Newest first. `events`: oldest first. */
export function logLines(events: readonly Event[]): readonly LogLine[] {
  // Ordered by their newest event.
  const lines = new Map<string, LogLine>();
  for (const event of events) {
    const key = foldKey(event);
    const before = lines.get(key);
    lines.delete(key);
    const goesOn = before !== undefined && event.time - before.event.time <= mostApart;
    if (before !== undefined && !goesOn) lines.set(String(before.event.id), before);
    const times = goesOn ? before.times + 1 : 1;
    lines.set(key, { event, times, since: goesOn ? before.since : event.time });
  }
  return [...lines.values()].sort((a, b) => Number(b.event.id - a.event.id));
}

/** Key that is equal for repeated refusals, whatever the number of cells. */
function foldKey({ kind, id, client, robot, world, text }: Event): string {
  if (kind !== EventKind.EVENT_REFUSED) return String(id);
  return [client, world, robot, text.replace(/\d+ cells?/, "cells")].join("\n");
}
