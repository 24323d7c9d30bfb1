import { type Alert, Severity } from "../../protocol/generated/console_pb";
import { type AlertPlace, placeOf } from "../../state/selectors";

interface SortedAlerts {
  readonly active: readonly Alert[];
  readonly acknowledged: readonly Alert[];
  readonly shelved: readonly Alert[];
  readonly over: readonly Alert[];
}

/** Most severe first, then newest. */
export function sortAlerts(alerts: readonly Alert[], now: number): SortedAlerts {
  const ordered = [...alerts].sort((a, b) => b.severity - a.severity || b.raised - a.raised);
  const at = (place: AlertPlace) => ordered.filter((alert) => placeOf(alert, now) === place);
  return {
    active: at("active"),
    acknowledged: at("acknowledged"),
    shelved: at("shelved"),
    over: at("over"),
  };
}

export function severityText(severity: Severity): string {
  switch (severity) {
    case Severity.ALARM:
      return "▲ alarm";
    case Severity.WARNING:
      return "◆ warning";
    default:
      return "● notice";
  }
}

export function severityClass(severity: Severity): string {
  if (severity === Severity.ALARM) return "bad";
  return severity === Severity.WARNING ? "warn" : "quiet";
}
