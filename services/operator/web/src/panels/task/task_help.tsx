import { useConsole } from "../../app/console";
import { Modal } from "../../app/modal";
import { driveHelp } from "../../app/shortcuts";
import { shortcutsWith } from "../../map/shortcuts";
import { Keys } from "../help/help_dialog";
import { MapSigns } from "../help/map_signs";
import { Instructions } from "./instructions";
import { nextPictureKey, nothingNewKey, taskKeys } from "./task_keys";
import { isMappingTask, offersPaths } from "./task_state";

/** What a participant has to do, and with which keys. */
export function TaskHelp() {
  const { store } = useConsole();
  const state = store.state.value;
  const mapKeys = shortcutsWith(offersPaths(state), state.session?.drives ?? false);
  const answer = isMappingTask(state) ? nextPictureKey : nothingNewKey;
  const answers = isMappingTask(state) || state.session?.method === "ig-mcts";
  return (
    <Modal title="What to do, and keys" toRead>
      <Instructions />
      <div class="help">
        <Keys title="Task" rows={answers ? [answer, ...taskKeys] : taskKeys} />
        {state.session?.drives && <Keys title="Driving" rows={driveHelp} />}
        <Keys title="Map" rows={mapKeys} />
        <MapSigns participates offersPaths={offersPaths(state)} />
      </div>
    </Modal>
  );
}
