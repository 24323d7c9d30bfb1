import { expect, it } from "vitest";
import { emptyState } from "../../state/console_state";
import { fleetRow } from "./fleet_row";
import { groupsOf, matches } from "./groups";

const row = (name: string, more = {}) => ({ ...fleetRow(emptyState, 0, true, name), ...more });
const rows = [
  row("r1", { stopped: true }),
  row("r2", { wait: { why: "sent a picture", seconds: 3 } }),
  row("r10", { doing: "driving" }),
];
const worldOf = (robot: string) => (robot === "r10" ? "w2" : "w1");

it("robots are grouped by what they do, by world, and as the person chose", () => {
  const own = { "north wing": ["r2", "r99"] };
  const groups = groupsOf(rows, worldOf, own).map(({ name, robots }) => [name, robots]);
  expect(groups).toEqual([
    ["All", ["r1", "r2", "r10"]],
    ["Needs you", ["r2"]],
    ["Stopped", ["r1"]],
    ["w1", ["r1", "r2"]],
    ["w2", ["r10"]],
    ["north wing", ["r2"]],
  ]);
  expect(groupsOf(rows, () => "w1", {}).map(({ name }) => name)).not.toContain("w1");
});

it.each([
  ["", ["r1", "r2", "r10"]],
  ["R1", ["r1", "r10"]],
  ["w2", ["r10"]],
  ["picture w1", ["r2"]],
  ["stopped", ["r1"]],
  ["nothing", []],
])("a search for '%s' finds %j", (text, expected) => {
  const found = rows.filter((one) => matches(one, worldOf(one.name), text));
  expect(found.map(({ name }) => name)).toEqual(expected);
});
