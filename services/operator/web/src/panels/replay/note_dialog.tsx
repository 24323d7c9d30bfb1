import { useState } from "preact/hooks";
import { useConsole } from "../../app/console";
import { Modal } from "../../app/modal";
import { TextField } from "../../app/text_field";

/** A note about this moment, for the command log and the recording. */
export function NoteDialog() {
  const { actions } = useConsole();
  const [text, setText] = useState("");
  const save = (event: Event) => {
    event.preventDefault();
    if (text.trim() === "") return;
    void actions.note(text.trim());
    actions.closeDialog();
  };
  return (
    <Modal title="Note about this moment">
      <form class="dialog-form" onSubmit={save}>
        <TextField label="Text" limit={500} value={text} onValue={setText} />
        <p class="quiet">
          Everybody sees it in the log and on the time line; the recording keeps it.
        </p>
        <div class="row">
          <button type="submit" class="main" disabled={text.trim() === ""}>
            Save
          </button>
          <button type="button" onClick={() => actions.closeDialog()}>
            Cancel
          </button>
        </div>
      </form>
    </Modal>
  );
}
