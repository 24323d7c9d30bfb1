import { SunMoon } from "lucide-preact";
import type { ComponentChildren } from "preact";
import { useConsole } from "../../app/console";
import { Level, Role } from "../../protocol/generated/console_pb";
import { ageOf } from "../../state/freshness";
import { count, duration, milliseconds } from "../format";
import { pictureAge } from "../pictures/summary";
import { driveLimits } from "../robots/teleoperation";
import {
  framesSkipped,
  healthOf,
  levelClass,
  levelText,
  plannerTime,
  roundTripClass,
} from "./health";
import "./status.css";

/** Latency, health of the services, and who is here. */
export function LatencyStrip() {
  const { store } = useConsole();
  const state = store.state.value;
  const { roundTrip } = store.timing.value;
  const skipped = framesSkipped(state);
  const age = pictureAge(state, store.chosenPicture.value, store.now.value);
  return (
    <section class="strip latency" aria-label="Latency and health">
      <Item name="Link">
        <LinkState />
      </Item>
      <Item name="Round trip">
        <span class={roundTripClass(roundTrip, driveLimits(state))}>{milliseconds(roundTrip)}</span>
      </Item>
      <Item name="Planner" spare>
        {milliseconds(plannerTime(state.searches))}
      </Item>
      <Item name="Picture age" spare>
        {duration(age)}
      </Item>
      {skipped > 0 && <Item name="Frames skipped">{skipped}</Item>}
      {store.pending.value > 0 && (
        <Item name="Pending">{count(store.pending.value, "request")}</Item>
      )}
      {state.session?.method && (
        <Item name="Method" spare>
          {state.session.method}
        </Item>
      )}
      <Services />
      <People />
      <PageButtons />
    </section>
  );
}

interface ItemProps {
  name: string;
  children: ComponentChildren;
  /** Hidden in small windows. */
  spare?: boolean;
}

function Item({ name, children, spare = false }: ItemProps) {
  return (
    <span class={`item ${spare ? "spare" : ""}`}>
      <span class="quiet">{name}</span> {children}
    </span>
  );
}

function LinkState() {
  const { state } = useConsole().store.link.value;
  const kind = { connecting: "warn", live: "good", stale: "warn", lost: "bad", closed: "bad" };
  const sign = { connecting: "◌", live: "●", stale: "◐", lost: "○", closed: "✕" };
  return (
    <span class={kind[state]}>
      {sign[state]} {state}
    </span>
  );
}

/** Counts the healthy services and names the others. The tooltip lists all. */
function Services() {
  const { store } = useConsole();
  const services = [...store.state.value.services.values()];
  if (services.length === 0) return undefined;
  const details = services.map(
    ({ name, level, message, receivedAt }) =>
      `${name}: ${levelText(level)}, ${message} (${duration(ageOf(receivedAt, store.now.value))} ago)`,
  );
  const { ok, ill } = healthOf(services);
  const unknown = !store.linked.value;
  return (
    <span class="services" title={details.join("\n")}>
      <span class="quiet">Services</span>
      {unknown && <span class={levelClass(undefined)}>{levelText(undefined)}</span>}
      {!unknown && ok > 0 && <span class={levelClass(Level.OK)}>● {ok} ok</span>}
      {!unknown &&
        ill.map(({ name, level }) => (
          <span key={name} class={levelClass(level)}>
            {name} {levelText(level)}
          </span>
        ))}
    </span>
  );
}

function People() {
  const { store } = useConsole();
  const { presence, welcome } = store.state.value;
  const people = presence?.people ?? [];
  const names = people.map(({ client, name, role }) => {
    const me = client === welcome?.client ? " (you)" : "";
    return `${name}${me}, ${roleText(role)}`;
  });
  return (
    <span class="item end" title={names.join("\n")}>
      {count(people.length, "person", "people")} here{" "}
      <span class="quiet">{welcome && `you ${roleText(welcome.role)}`}</span>
    </span>
  );
}

/** Words that are not names of people or services. */
function roleText(role: Role): string {
  if (role === Role.ADMIN) return "administrator";
  return role === Role.OPERATOR ? "may command" : "may watch";
}

/** Buttons for the page's own display; each has a key, too. */
function PageButtons() {
  const { store, commands } = useConsole();
  const { workload, events, fleet, sound, theme } = store.settings.value;
  return (
    <span class="row page-buttons">
      <button type="button" aria-pressed={fleet} onClick={commands.fleet}>
        Fleet
      </button>
      <button type="button" aria-pressed={workload} onClick={commands.workload}>
        Workload
      </button>
      <button type="button" aria-pressed={events} onClick={commands.events}>
        Log
      </button>
      <button
        type="button"
        aria-pressed={sound}
        title="Alarms are heard"
        onClick={() => {
          store.settings.value = { ...store.settings.value, sound: !sound };
        }}
      >
        Sound
      </button>
      <button type="button" title="Switch theme: dark, light, system" onClick={commands.theme}>
        <SunMoon size={14} /> <span class="unseen">Theme: </span>
        {theme}
      </button>
      <button type="button" onClick={commands.help} aria-label="Help: all keys">
        ?
      </button>
    </span>
  );
}
