import { useConsole } from "../../app/console";
import { Modal } from "../../app/modal";
import { driveHelp } from "../../app/shortcuts";
import { shortcutsWith, solidKey } from "../../map/shortcuts";
import { percent } from "../format";
import { Keys, MapSigns } from "../guide/help_dialog";
import { MethodText } from "../guide/method_text";
import { nextPictureKey, nothingNewKey, robotKeys, taskKeys, themeKey } from "./task_keys";
import { hasSeveralRobots, isMappingTask, offersPaths, stepTitle } from "./task_state";

/** Shown before a maze starts. The robot is stopped until the participant begins. */
export function BeginDialog() {
  const { store } = useConsole();
  const state = store.state.value;
  const { task } = state;
  if (task === undefined) return undefined;
  const last = task.earlier.at(-1);
  return (
    <Modal title={stepTitle(state)}>
      {last !== undefined && (
        <p class="task-result">
          {`You corrected ${percent(last)} of the mistakes of the map before. The next one is ready.`}
        </p>
      )}
      <Instructions />
      <BeginButton />
    </Modal>
  );
}

export function BeginButton() {
  const { store, actions } = useConsole();
  const begin = () => {
    actions.closeDialog();
    store.chosenSequence.value = undefined;
    if (isMappingTask(store.state.value)) store.tool.value = "wall";
    void actions.resume(store.robots.value);
  };
  return (
    <button
      type="button"
      class="main"
      disabled={store.state.value.worlds.size === 0}
      onClick={begin}
    >
      Begin
    </button>
  );
}

/** Instructions and keys for a participant. */
export function TaskHelp() {
  const { store } = useConsole();
  const state = store.state.value;
  const drives = state.session?.drives ?? false;
  const mapKeys = shortcutsWith(offersPaths(state), drives, false).filter(
    ({ keys }) => !keys.includes(solidKey),
  );
  const answer = isMappingTask(state) ? nextPictureKey : nothingNewKey;
  const keys = taskKeys.filter(({ keys: [key] }) => key !== themeKey || isMappingTask(state));
  const answers = isMappingTask(state) || state.session?.method === "ig-mcts";
  return (
    <Modal title="Instructions and keys" toRead>
      <Instructions />
      <div class="help">
        <Keys title="Task" rows={answers ? [answer, ...keys] : keys} />
        {hasSeveralRobots(state) && <Keys title="Robots" rows={robotKeys} />}
        {state.session?.drives && <Keys title="Driving" rows={driveHelp} />}
        <Keys title="Map" rows={mapKeys} />
        <MapSigns participates offersPaths={offersPaths(state)} />
      </div>
    </Modal>
  );
}

/** Instructions for the mapping task, or for the method of this part of the study. */
function Instructions() {
  const state = useConsole().store.state.value;
  if (state.task?.introduction) return <Paragraphs text={state.task.introduction} />;
  if (isMappingTask(state)) return <Mapping />;
  const method = state.session?.method ?? "";
  return (
    <ol class="instructions">
      <li>
        This is your map of a maze. Parts of it are wrong: some walls are missing, others do not
        exist. Lead the robot to all its goals ⚑. Correct the map as you learn more: draw missing
        walls with <kbd>W</kbd>, erase wrong ones with <kbd>E</kbd>.
      </li>
      <li>
        <MethodText method={method} many={false} />
      </li>
      <li>When the robot has reached all goals, you may finish this part.</li>
    </ol>
  );
}

/** Plain text; empty lines separate its paragraphs. */
export function Paragraphs({ text }: { text: string }) {
  return (
    <div class="introduction">
      {text
        .trim()
        .split(/\n\s*\n/)
        .map((paragraph) => (
          <p key={paragraph}>{paragraph}</p>
        ))}
    </div>
  );
}

function Mapping() {
  return (
    <ol class="instructions">
      <li>
        This is your map of a maze. Parts of it are wrong: some walls are missing, others do not
        exist.
      </li>
      <li>
        A robot drives through the real maze. It sends you one picture at a time. The cone on the
        map shows where it stood and where its camera looked.
      </li>
      <li>
        Compare the picture with your map. Draw missing walls with <kbd>W</kbd>, erase wrong ones
        with <kbd>E</kbd>. Then ask for the next picture with <kbd>N</kbd>.
      </li>
      <li>When the robot has reached all its goals ⚑, you may finish the maze or continue.</li>
    </ol>
  );
}
