import type { FleetRow } from "./fleet_row";

interface RobotGroup {
  readonly name: string;
  readonly robots: readonly string[];
  /** The person made it, and can delete it. */
  readonly own: boolean;
}

/** Groups to choose from: by what robots do, by world if there are several, and the person's own. */
export function groupsOf(
  rows: readonly FleetRow[],
  worldOf: (robot: string) => string,
  own: Readonly<Record<string, readonly string[]>>,
): readonly RobotGroup[] {
  const those = (name: string, is: (row: FleetRow) => boolean): RobotGroup => ({
    name,
    robots: rows.filter(is).map((row) => row.name),
    own: false,
  });
  const worlds = [...new Set(rows.map(({ name }) => worldOf(name)))].filter(Boolean).sort();
  const known = new Set(rows.map(({ name }) => name));
  return [
    those("All", () => true),
    those("Needs you", ({ wait }) => wait !== undefined),
    those("Stopped", ({ stopped }) => stopped),
    ...(worlds.length > 1
      ? worlds.map((world) => those(world, (row) => worldOf(row.name) === world))
      : []),
    ...Object.entries(own).map(([name, robots]) => ({
      name,
      robots: robots.filter((robot) => known.has(robot)),
      own: true,
    })),
  ];
}

/** Whether each word of `text` is in the robot's name, world or state. */
export function matches(row: FleetRow, world: string, text: string): boolean {
  const { name, doing, wait, stopped, freshness } = row;
  const words = [name, world, doing, wait?.why, stopped && "stopped", freshness].filter(Boolean);
  const all = words.join(" ").toLowerCase();
  return text
    .toLowerCase()
    .split(/\s+/)
    .every((word) => all.includes(word));
}
