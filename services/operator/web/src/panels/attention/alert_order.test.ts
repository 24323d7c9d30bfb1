import { create } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { AlertSchema, Severity } from "../../protocol/generated/console_pb";
import { sortAlerts } from "./alert_order";

const alert = (id: bigint, severity: Severity, raised: number, more = {}) =>
  create(AlertSchema, { id, severity, raised, active: true, ...more });

describe("alerts", () => {
  it("are sorted by severity, then newest first", () => {
    const { active } = sortAlerts(
      [
        alert(1n, Severity.NOTICE, 9),
        alert(2n, Severity.ALARM, 1),
        alert(3n, Severity.WARNING, 2),
        alert(4n, Severity.WARNING, 5),
      ],
      100,
    );
    expect(active.map(({ id }) => id)).toEqual([2n, 4n, 3n, 1n]);
  });

  it("are sorted into places, and history when over", () => {
    const sorted = sortAlerts(
      [
        alert(1n, Severity.NOTICE, 1, { acknowledgedBy: "me" }),
        alert(2n, Severity.NOTICE, 1, { shelvedUntil: 200 }),
        alert(3n, Severity.NOTICE, 1, { acknowledgedBy: "me", active: false }),
        alert(4n, Severity.NOTICE, 1, { active: false }),
      ],
      100,
    );
    expect(sorted.acknowledged.map(({ id }) => id)).toEqual([1n]);
    expect(sorted.shelved.map(({ id }) => id)).toEqual([2n]);
    expect(sorted.active).toEqual([]);
    expect(sorted.over.map(({ id }) => id)).toEqual([3n, 4n]);
  });
});
