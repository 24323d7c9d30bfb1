import { useConsole } from "../../app/console";
import { RobotMark } from "../../app/robot_mark";
import { Mode } from "../../protocol/generated/console_pb";
import { mayCommand, mayStop } from "../../state/selectors";
import { duration } from "../format";
import { controlText, type FleetRow, fleetRow } from "./fleet_row";
import "./fleet.css";

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
  const row = fleetRow(store.state.value, store.now.value, store.linked.value, name);
  const chosen = store.chosenRobot.value === name;
  const recorded = store.state.value.welcome?.mode === Mode.REPLAY;
  return (
    <li class={`fleet-card ${row.freshness === "live" ? "" : "old"} ${row.wait ? "waits" : ""}`}>
      <button
        type="button"
        class="choose"
        aria-pressed={chosen}
        title={`${doing(row)}\n${controlText(row, recorded)}`}
        onClick={() => actions.goTo(name)}
      >
        <span class="row">
          <RobotMark robot={name} />
          <strong>{name}</strong>
          <FreshnessBadge row={row} />
          <span class="end" title="goals reached">
            ⚑ {row.goalsReached}/{row.goalsTotal}
          </span>
        </span>
        <span class="sign" aria-hidden="true">
          {row.wait ? "!" : row.stopped ? "■" : ""}
        </span>
        <span class="doing">{doing(row)}</span>
        {row.holder.kind === "other" && <span class="holder">{row.holder.name} has control</span>}
      </button>
      {mayStop(store.state.value) && <StopOrGo row={row} />}
    </li>
  );
}

function FreshnessBadge({ row: { freshness, age } }: { row: FleetRow }) {
  const signs = { live: "●", stale: "◐", lost: "○", "no news": "◌" };
  const kind = { live: "good", stale: "warn", lost: "bad", "no news": "bad" };
  const old = freshness === "live" || age === undefined ? "" : ` ${duration(age)}`;
  return (
    <span class={kind[freshness]}>
      {signs[freshness]}
      <span class="word">
        {" "}
        {freshness}
        {old}
      </span>
    </span>
  );
}

function StopOrGo({ row: { name, stopped } }: { row: FleetRow }) {
  const { store, actions } = useConsole();
  const may = !stopped || mayCommand(store.state.value);
  const act = () => void (stopped ? actions.go([name]) : actions.stop([name]));
  const word = stopped ? "Go" : "Stop";
  return (
    <button
      type="button"
      class="stop-or-go"
      disabled={!may}
      title={word}
      aria-label={`${word} ${name}`}
      onClick={act}
    >
      {stopped ? "▶" : "■"}
    </button>
  );
}

function doing({ wait, stopped, doing: does }: FleetRow): string {
  if (stopped) return "■ stopped";
  return wait ? `! ${wait.why}, ${duration(wait.seconds)}` : does;
}
