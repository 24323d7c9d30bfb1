import { useConsole } from "../../app/console";
import { Modal } from "../../app/modal";
import { RobotMark } from "../../app/robot_mark";
import { driveHelp, type Group, keyParts, shortcuts } from "../../app/shortcuts";
import { shortcutsWith } from "../../map/shortcuts";
import { Mode } from "../../protocol/generated/console_pb";
import { offersPaths } from "../task/task_state";
import { signs } from "./sign_table";
import "./guide.css";

interface Row {
  readonly keys: readonly string[];
  readonly text: string;
}

const groups: readonly Group[] = ["Safety", "Attention", "Robots", "Page"];

/** All keys and all symbols. */
export function HelpDialog() {
  const { store } = useConsole();
  const state = store.state.value;
  const { session, welcome } = state;
  const setsGoals = (session?.goalRobots.length ?? 0) > 0;
  const mapKeys = shortcutsWith(offersPaths(state), session?.drives ?? false, setsGoals);
  return (
    <Modal title="Keys and symbols" toRead>
      <div class="help">
        {groups.map((group) => (
          <Keys key={group} title={group} rows={of(group)} />
        ))}
        <Keys title="Map" rows={mapKeys} />
        {session?.drives && <Keys title="Driving" rows={driveHelp} />}
        {welcome?.mode === Mode.REPLAY && <Keys title="Recording" rows={of("Recording")} />}
        <MapSigns participates={false} offersPaths={offersPaths(state)} />
        <Legend />
        <YourName />
      </div>
    </Modal>
  );
}

function of(group: Group): readonly Row[] {
  return shortcuts.filter((shortcut) => shortcut.group === group);
}

export function Keys({ title, rows }: { title: string; rows: readonly Row[] }) {
  return rows.length === 0 ? undefined : (
    <section>
      <h3>{title}</h3>
      <dl>
        {rows.map(({ keys, text }) => (
          <div key={text}>
            <dt>
              {keys.map((key, i) => (
                <span key={key}>
                  {i > 0 && " or "}
                  {keyParts(key).map((part) => (
                    <kbd key={part}>{part}</kbd>
                  ))}
                </span>
              ))}
            </dt>
            <dd>{text}</dd>
          </div>
        ))}
      </dl>
    </section>
  );
}

function Legend() {
  const { store } = useConsole();
  return (
    <section>
      <h3>Status symbols</h3>
      <p>
        <span class="good">● live</span>: reports normally. <span class="warn">◐ stale</span>:
        silent for 1 s. <span class="bad">○ lost</span>: silent for 3 s. <strong>!</strong> needs
        you. ■ stopped. ⚑ goals reached.
      </p>
      <ul class="row">
        {store.robots.value.map((name) => (
          <li key={name} class="row">
            <RobotMark robot={name} /> {name}
          </li>
        ))}
      </ul>
    </section>
  );
}

function YourName() {
  const { rename, store, actions } = useConsole();
  const save = (event: SubmitEvent) => {
    event.preventDefault();
    if (!(event.currentTarget instanceof HTMLFormElement)) return;
    void rename(String(new FormData(event.currentTarget).get("name") ?? ""));
    actions.closeDialog();
  };
  return (
    <section>
      <h3>You</h3>
      <form class="row" onSubmit={save}>
        <label>
          Name{" "}
          <input name="name" type="text" maxLength={40} defaultValue={store.name.value} size={14} />
        </label>
        <button type="submit">Save</button>
      </form>
    </section>
  );
}

/** Meaning of the map's colours and shapes. For the properties see MapProps. */
export function MapSigns(props: { participates: boolean; offersPaths: boolean }) {
  const shown = signs
    .filter(({ secret }) => !(secret && props.participates))
    .filter(({ path }) => !path || props.offersPaths);
  return (
    <section class="map-signs">
      <h3>Map symbols</h3>
      <ul>
        {shown.map(({ text, sign }) => (
          <li key={text}>
            {sign}
            {text}
          </li>
        ))}
      </ul>
    </section>
  );
}
