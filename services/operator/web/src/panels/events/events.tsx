import { useConsole } from "../../app/console";
import { type Event, EventKind } from "../../protocol/generated/console_pb";
import { nameOf } from "../../state/selectors";
import { timeOfDay } from "../format";
import "./events.css";

const mostShown = 200;

/** Who asked for what, newest first. */
export function Events() {
  const { store } = useConsole();
  const state = store.state.value;
  const shown = state.events.slice(-mostShown).reverse();
  return (
    <section class="panel events" aria-label="Command log">
      <h2>Command log</h2>
      {shown.length === 0 && <p class="quiet">Nothing was asked for yet.</p>}
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: who has no mouse scrolls it by the keyboard. */}
      <ol tabIndex={0}>
        {shown.map((event) => (
          <li key={String(event.id)} class={event.kind === EventKind.EVENT_REFUSED ? "warn" : ""}>
            <time class="quiet">{timeOfDay(event.time)}</time>{" "}
            <strong>{nameOf(state, event.client)}</strong> {textOf(event)}
          </li>
        ))}
      </ol>
    </section>
  );
}

function textOf({ text, robot, world }: Event): string {
  const about = robot || world;
  return about === "" || text.includes(about) ? text : `${about}: ${text}`;
}
