import { useComputed } from "@preact/signals";
import { useMemo } from "preact/hooks";
import { useConsole } from "../../app/console";
import { RobotMark } from "../../app/robot_mark";
import { Mode } from "../../protocol/generated/console_pb";
import { mayStop } from "../../state/selectors";
import { computedByValue } from "../../state/store";
import { duration } from "../format";
import { controlText, type FleetRow, fleetRow } from "./fleet_row";
import "./robots.css";

/** More robots than these get small cards, so that all are in sight. */
const mostLarge = 8;

/** Every robot at a glance: how fresh its state is, goals, whether it waits for the operator. */
export function FleetStrip() {
  const { store } = useConsole();
  const names = store.robots.value;
  return (
    <nav
      class={`fleet ${names.length > mostLarge ? "compact" : ""}`}
      aria-label="Robots"
      data-tour="fleet"
    >
      {names.length === 0 && <p class="quiet">No robot was heard of yet.</p>}
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
    <li class={`fleet-card ${row.freshness === "live" ? "" : "old"} ${row.wait ? "waits" : ""}`}>
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
            <span class="flag">⚑ </span>
            {row.goalsTotal > 0 ? `${row.goalsReached}/${row.goalsTotal}` : "–"}
          </span>
        </span>
        <span class="sign" aria-hidden="true">
          {row.wait ? "!" : row.stopped ? "■" : ""}
        </span>
        <span class="doing">{doing(row)}</span>
        {row.holder.kind === "other" && <span class="holder">{row.holder.name} has control</span>}
      </button>
      {maySeeStop && <StopAndGo row={row} />}
    </li>
  );
}

/** Robots tell of themselves many times a second, what a card says changes seldom. */
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
  const signs = { live: "●", stale: "◐", lost: "○", "no news": "◌", "not heard yet": "◌" };
  const kind = {
    live: "good",
    stale: "warn",
    lost: "bad",
    "no news": "bad",
    "not heard yet": "warn",
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

/** Stop keeps its place: what is about to be pressed never turns into Go. */
function StopAndGo({ row: { name, stopped } }: { row: FleetRow }) {
  const { store, actions } = useConsole();
  return (
    <>
      {stopped && (
        <button
          type="button"
          class="go"
          disabled={!store.canCommand.value}
          title="Go"
          aria-label={`Go ${name}`}
          onClick={() => void actions.go([name])}
        >
          ▶
        </button>
      )}
      <button
        type="button"
        title="Stop"
        aria-label={`Stop ${name}`}
        onClick={() => void actions.stop([name])}
      >
        ■
      </button>
    </>
  );
}

function doing({ wait, stopped, doing: does }: FleetRow): string {
  if (stopped) return "■ stopped";
  return wait ? `! ${wait.why}, ${duration(wait.seconds)}` : does;
}
