import { useConsole } from "../../app/console";
import type { Alert } from "../../protocol/generated/console_pb";
import { nameOf } from "../../state/selectors";
import { duration, timeOfDay } from "../format";
import { severityClass, severityText, sortAlerts } from "./alert_order";
import "./attention.css";

/** s that an alert is shelved. */
const shelveTime = 300;

/** All alerts that the service keeps, so they survive a reload. */
export function Alerts() {
  const { store } = useConsole();
  const { active, acknowledged, shelved, over } = sortAlerts(
    store.state.value.alerts,
    store.now.value ?? 0,
  );
  const none = active.length + acknowledged.length + shelved.length === 0;
  return (
    <section class="panel alerts" aria-label="Alerts">
      <h2 class={active.length > 0 ? "bad" : ""}>Alerts ({active.length})</h2>
      {none && <p class="quiet">Nothing is wrong.</p>}
      <AlertList alerts={active} />
      <AlertGroup title="Acknowledged, still active" alerts={acknowledged} />
      <AlertGroup title="Shelved" alerts={shelved} />
      <AlertGroup title="Over" alerts={over} />
    </section>
  );
}

function AlertGroup({ title, alerts }: { title: string; alerts: readonly Alert[] }) {
  return alerts.length === 0 ? undefined : (
    <details>
      <summary>
        {title} ({alerts.length})
      </summary>
      <AlertList alerts={alerts} />
    </details>
  );
}

function AlertList({ alerts }: { alerts: readonly Alert[] }) {
  return (
    <ul>
      {alerts.map((alert) => (
        <AlertItem key={String(alert.id)} alert={alert} />
      ))}
    </ul>
  );
}

function AlertItem({ alert }: { alert: Alert }) {
  const { store, actions } = useConsole();
  const { id, severity, source, text, advice, count, active, acknowledgedBy } = alert;
  const now = store.now.value ?? alert.newest;
  const may = store.canCommand.value;
  return (
    <li>
      <p>
        <strong class={severityClass(severity)}>{severityText(severity)}</strong>{" "}
        <strong>{source}</strong> {text}
        {count > 1 && ` (${count} times)`}
      </p>
      {advice !== "" && <p>{advice}</p>}
      <p class="row quiet">
        <span title={timeOfDay(alert.raised)}>
          {duration(Math.max(0, now - alert.raised))} ago{!active && ", over"}
          {acknowledgedBy !== "" &&
            `, acknowledged by ${nameOf(store.state.value, acknowledgedBy)}`}
        </span>
        {active && acknowledgedBy === "" && (
          <button
            type="button"
            class="end"
            disabled={!may}
            onClick={() => void actions.acknowledge(id)}
          >
            Acknowledge
          </button>
        )}
        {active && alert.shelvedUntil <= now && (
          <button type="button" disabled={!may} onClick={() => void actions.shelve(id, shelveTime)}>
            Shelve {duration(shelveTime)}
          </button>
        )}
      </p>
    </li>
  );
}
