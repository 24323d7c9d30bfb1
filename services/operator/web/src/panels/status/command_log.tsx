import { useComputed } from "@preact/signals";
import { useConsole } from "../../app/console";
import { type Event, EventKind } from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";
import { nameOf, withNames } from "../../state/selectors";
import { timeOfDay } from "../format";
import "./status.css";

const mostShown = 200;

/** Who asked for what, newest first. */
export function Events() {
  const { store } = useConsole();
  const state = store.state.value;
  const events = useComputed(() => store.state.value.events);
  const shown = useComputed(() => logLines(events.value).slice(0, mostShown)).value;
  return (
    <section class="panel events" aria-label="Command log">
      <h2>Command log</h2>
      {shown.length === 0 && <p class="quiet">Nothing was asked for yet.</p>}
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: who has no mouse scrolls it by the keyboard. */}
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

function textOf(state: ConsoleState, { text: told, robot, world }: Event): string {
  const about = robot || world;
  const text = withNames(state, told);
  return about === "" || text.includes(about) ? text : `${about}: ${text}`;
}

/** A line of the command log: an event, or refusals of the same request one after the other. */
interface LogLine {
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
