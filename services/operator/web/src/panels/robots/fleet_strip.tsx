import { useComputed } from "@preact/signals";
import { Flag, Play, Square } from "lucide-preact";
import { useMemo } from "preact/hooks";
import { useConsole } from "../../app/console";
import { RobotMark } from "../../app/robot_mark";
import { Mode } from "../../protocol/generated/console_pb";
import { mayStop } from "../../state/selectors";
import { computedByValue } from "../../state/store";
import { duration } from "../format";
import { controlText, type FleetRow, fleetRow } from "./fleet_row";
import "./robots.css";

// Made once: Preact does not look at the same element again.
const flag = (
  <span class="flag">
    <Flag size={12} />{" "}
  </span>
);
const play = <Play size={12} />;
const square = <Square size={12} fill="currentColor" />;

/** With more robots the cards get smaller, so that all fit. */
const mostLarge = 8;

/** All robots at a glance: age of their state, goals, and whether they wait for the operator. */
export function FleetStrip() {
  const { store } = useConsole();
  const names = store.robots.value;
  return (
    <nav
      class={`fleet ${names.length > mostLarge ? "compact" : ""}`}
      aria-label="Robots"
      data-tour="fleet"
      data-area="robots"
    >
      {names.length === 0 && <p class="quiet">No robot has reported yet.</p>}
      <ul>
        {names.map((name) => (
          <FleetCard key={name} name={name} />
        ))}
      </ul>
    </nav>
  );
}

function FleetCard({ name }: { name: string }) {
  const { store, actions } = useConsole();
  const row = useRow(name);
  const chosen = store.chosenRobot.value === name;
  const maySeeStop = useComputed(() => mayStop(store.state.value)).value;
  const recorded = useComputed(() => store.state.value.welcome?.mode === Mode.REPLAY).value;
  return (
    <li
      class={`fleet-card ${row.freshness === "live" ? "" : "old"} ${row.stopped ? "stopped" : row.wait ? "waits" : ""}`}
    >
      <button
        type="button"
        class="choose"
        aria-pressed={chosen}
        title={[doing(row), row.stop, controlText(row, recorded)].filter(Boolean).join("\n")}
        onClick={() => actions.goTo(name)}
      >
        <span class="row">
          <RobotMark robot={name} />
          <strong>{name}</strong>
          <FreshnessBadge row={row} />
          <span class="end" title="goals reached">
            {flag}
            {row.goalsTotal > 0 ? `${row.goalsReached}/${row.goalsTotal}` : "–"}
          </span>
        </span>
        <span class="sign" aria-hidden="true">
          {row.stopped ? "■" : row.wait ? "!" : ""}
        </span>
        <span class="doing">{doing(row)}</span>
        <span class="holder">
          {row.holder.kind === "other" ? `${row.holder.name} has control` : ""}
        </span>
      </button>
      {maySeeStop && <StopAndResume row={row} />}
    </li>
  );
}

/** Robots report many times a second, but their cards rarely change. */
function useRow(name: string): FleetRow {
  const { store } = useConsole();
  const row = useMemo(
    () =>
      computedByValue(() => {
        const now = fleetRow(store.state.value, store.now.value, store.linked.value, name);
        return now.freshness === "live" ? { ...now, age: undefined } : now;
      }),
    [store, name],
  );
  return row.value;
}

function FreshnessBadge({ row: { freshness, age } }: { row: FleetRow }) {
  const signs = { live: "●", stale: "◐", lost: "○", unknown: "◌", "no data yet": "◌" };
  const kind = {
    live: "good",
    stale: "warn",
    lost: "bad",
    unknown: "bad",
    "no data yet": "warn",
  };
  const old = freshness === "live" || age === undefined ? "" : ` ${duration(age)}`;
  return (
    <span class={`freshness ${kind[freshness]}`}>
      {signs[freshness]}
      <span class="word">
        {" "}
        {freshness}
        {old}
      </span>
    </span>
  );
}

/** Stop and resume are separate buttons, so that a press meant to stop never resumes. */
function StopAndResume({ row: { name, stopped } }: { row: FleetRow }) {
  const { store, actions } = useConsole();
  return (
    <>
      {stopped && (
        <button
          type="button"
          class="go"
          disabled={!store.canCommand.value}
          title="Resume"
          aria-label={`Resume ${name}`}
          onClick={() => void actions.resume([name])}
        >
          {play}
        </button>
      )}
      <button
        type="button"
        title="Stop"
        aria-label={`Stop ${name}`}
        onClick={() => void actions.stop([name])}
      >
        {square}
      </button>
    </>
  );
}

function doing({ wait, stopped, doing: does }: FleetRow): string {
  return wait && !stopped ? `! ${wait.why}, ${duration(wait.seconds)}` : does;
}
