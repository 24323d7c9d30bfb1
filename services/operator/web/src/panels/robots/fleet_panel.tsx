import { useSignal } from "@preact/signals";
import { Play, Square, X } from "lucide-preact";
import { useConsole } from "../../app/console";
import { RobotMark } from "../../app/robot_mark";
import { mayStop } from "../../state/selectors";
import { count } from "../format";
import { type FleetRow, fleetRow } from "./fleet_row";
import { groupsOf, matches } from "./groups";
import "./robots.css";

/** All robots as a list: search, groups, and commands for the robots that are ticked. */
export function FleetPanel() {
  const { store } = useConsole();
  const text = useSignal("");
  const ticked = useSignal<ReadonlySet<string>>(new Set());
  const state = store.state.value;
  const rows = store.robots.value.map((name) =>
    fleetRow(state, store.now.value, store.linked.value, name),
  );
  const shown = rows.filter((row) => matches(row, worldOf(row.name), text.value));
  const names = rows.map(({ name }) => name).filter((name) => ticked.value.has(name));
  function worldOf(robot: string): string {
    return state.robots.get(robot)?.world ?? "";
  }
  const tick = (robots: readonly string[], on: boolean) => {
    const next = new Set(ticked.value);
    for (const robot of robots) on ? next.add(robot) : next.delete(robot);
    ticked.value = next;
  };
  return (
    <section class="panel fleet-panel" aria-label="Fleet">
      <div class="row">
        <h2>Fleet</h2>
        <input
          type="search"
          aria-label="Search robots"
          placeholder="Name, world or state"
          value={text.value}
          onInput={(event) => {
            text.value = event.currentTarget.value;
          }}
        />
        <span class="quiet">
          {shown.length} of {count(rows.length, "robot")}
        </span>
      </div>
      <Groups rows={rows} worldOf={worldOf} tick={(robots) => (ticked.value = new Set(robots))} />
      <ol>
        {shown.map((row) => (
          <Row
            key={row.name}
            row={row}
            world={worldOf(row.name)}
            ticked={ticked.value.has(row.name)}
            tick={(on) => tick([row.name], on)}
          />
        ))}
      </ol>
      <Commands robots={names} />
    </section>
  );
}

interface GroupsProps {
  readonly rows: readonly FleetRow[];
  worldOf(robot: string): string;
  tick(robots: readonly string[]): void;
}

/** One press ticks all robots of a group. */
function Groups({ rows, worldOf, tick }: GroupsProps) {
  const { store } = useConsole();
  const { groups } = store.settings.value;
  const remove = (name: string) => {
    const { [name]: _, ...others } = groups;
    store.settings.value = { ...store.settings.value, groups: others };
  };
  return (
    <div class="row groups">
      {groupsOf(rows, worldOf, groups).map(({ name, robots, own }) => (
        <span key={name}>
          <button type="button" disabled={robots.length === 0} onClick={() => tick(robots)}>
            {name} ({robots.length})
          </button>
          {own && (
            <button
              type="button"
              aria-label={`Delete the group ${name}`}
              onClick={() => remove(name)}
            >
              <X size={12} />
            </button>
          )}
        </span>
      ))}
    </div>
  );
}

interface RowProps {
  readonly row: FleetRow;
  readonly world: string;
  readonly ticked: boolean;
  tick(on: boolean): void;
}

function Row({ row, world, ticked, tick }: RowProps) {
  const { actions } = useConsole();
  const { name, wait, stopped, doing, goalsReached, goalsTotal } = row;
  return (
    <li>
      <input
        type="checkbox"
        aria-label={`Choose ${name} for commands`}
        checked={ticked}
        onChange={(event) => tick(event.currentTarget.checked)}
      />
      <button type="button" class="choose" onClick={() => actions.goTo(name)}>
        <RobotMark robot={name} />
        <strong>{name}</strong>
        <span class="quiet">{world}</span>
        <span class={stopped ? "bad" : wait ? "warn" : ""}>
          {stopped ? doing : (wait?.why ?? doing)}
        </span>
        <span class="end quiet">
          {goalsReached}/{goalsTotal}
        </span>
      </button>
    </li>
  );
}

/** For the robots that are ticked; names each of them. */
function Commands({ robots }: { robots: readonly string[] }) {
  const { store, actions } = useConsole();
  const name = useSignal("");
  const none = robots.length === 0;
  const which = none ? "no robot is ticked" : robots.join(", ");
  const save = (event: Event) => {
    event.preventDefault();
    const { settings } = store;
    const groups = { ...settings.value.groups, [name.value.trim()]: robots };
    settings.value = { ...settings.value, groups };
    name.value = "";
  };
  return (
    <div class="row">
      {mayStop(store.state.value) && (
        <button
          type="button"
          class="danger"
          disabled={none}
          aria-label={none ? "Stop" : `Stop ${count(robots.length, "robot")}`}
          title={`Stops ${which}`}
          onClick={() => void actions.stop(robots)}
        >
          <Square size={12} fill="currentColor" /> Stop
        </button>
      )}
      <button
        type="button"
        disabled={none || !store.canCommand.value}
        title={`Resumes ${which}`}
        onClick={() => void actions.resume(robots)}
      >
        <Play size={12} /> Resume
      </button>
      <button
        type="button"
        disabled={none || !store.canCommand.value}
        title={`Takes control of ${which}`}
        onClick={() => actions.takeControl(robots)}
      >
        Take control
      </button>
      <form class="row end" onSubmit={save}>
        <input
          type="text"
          size={10}
          maxLength={20}
          aria-label="Name of a group"
          placeholder="Group name"
          value={name.value}
          onInput={(event) => {
            name.value = event.currentTarget.value;
          }}
        />
        <button type="submit" disabled={none || name.value.trim() === ""}>
          Save group
        </button>
      </form>
    </div>
  );
}
