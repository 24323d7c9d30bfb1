import { useConsole } from "../../app/console";
import { Modal } from "../../app/modal";
import { mapShortcuts } from "../../map/shortcuts";
import { Keys } from "../help/help_dialog";
import { Instructions } from "./instructions";
import { taskKeys } from "./task_keys";

/** The keys of the mapping task. */
export function TaskHelp() {
  const { store } = useConsole();
  const close = () => {
    store.dialog.value = undefined;
  };
  const mapKeys = mapShortcuts.filter(({ keys }) => !pathKeys.has(keys[0] ?? ""));
  return (
    <Modal title="What to do, and keys" onClose={close} toRead>
      <Instructions />
      <div class="help">
        <Keys title="Task" rows={taskKeys} />
        <Keys title="Map" rows={mapKeys} />
      </div>
    </Modal>
  );
}

/** Of the path tool, and of layers. */
const pathKeys: ReadonlySet<string> = new Set(["P", "Delete"]);
