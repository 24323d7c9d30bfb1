import { useConsole } from "../../app/console";
import { Modal } from "../../app/modal";
import { percent } from "../format";
import { Instructions } from "./instructions";
import { isMappingTask, partName } from "./task_state";

/** The robot stands until the participant begins. */
export function BeginDialog() {
  const { store } = useConsole();
  const state = store.state.value;
  const { task } = state;
  const part = partName(state);
  if (task === undefined) return undefined;
  const last = task.earlier.at(-1);
  return (
    <Modal title={`${part} ${task.number} of ${task.count}`}>
      {last !== undefined && (
        <p class="task-result">
          {part} {task.number - 1}: you corrected {percent(last)} of the map's mistakes. The next
          one is ready.
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
    void actions.go(store.robots.value);
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
