import { useConsole } from "../../app/console";
import { RobotMark } from "../../app/robot_mark";
import { mayCommand, mayStop } from "../../state/selectors";
import { duration } from "../format";
import { type FleetRow, fleetRow } from "./fleet_row";
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
  const row = fleetRow(store.state.value, store.now.value, name);
  const chosen = store.chosenRobot.value === name;
  return (
    <li class={`fleet-card ${row.freshness} ${row.wait ? "waits" : ""}`}>
      <button
        type="button"
        class="choose"
        aria-pressed={chosen}
        title={[doing(row), row.stop, whoControls(row)].filter(Boolean).join("\n")}
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
      </button>
      {mayStop(store.state.value) && <StopOrGo row={row} />}
    </li>
  );
}

function FreshnessBadge({ row: { freshness, age } }: { row: FleetRow }) {
  const signs = { live: "●", stale: "◐", lost: "○" };
  const kind = { live: "good", stale: "warn", lost: "bad" };
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

function doing({ wait, stopped, doing: does, holder }: FleetRow): string {
  const who = holder.kind === "other" ? ` · ${holder.name} has control` : "";
  if (stopped) return `■ stopped${who}`;
  return wait ? `! ${wait.why}, ${duration(wait.seconds)}${who}` : `${does}${who}`;
}

function whoControls({ holder, name }: FleetRow): string {
  if (holder.kind === "me") return `You have control of ${name}`;
  return holder.kind === "other"
    ? `${holder.name} has control of ${name}: ${holder.reason || "no reason given"}`
    : `Nobody has control of ${name}`;
}
