import { useComputed } from "@preact/signals";
import { useConsole } from "../../app/console";
import { type Event, EventKind } from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";
import { nameOf, withNames } from "../../state/selectors";
import { timeOfDay } from "../format";
import { logLines } from "./log_lines";
import "./events.css";

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
