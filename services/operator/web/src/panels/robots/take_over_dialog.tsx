import { useState } from "preact/hooks";
import { useConsole } from "../../app/console";
import { Modal } from "../../app/modal";
import { NameField } from "../../app/name_field";
import { TextField } from "../../app/text_field";
import type { TakeOver } from "../../state/store";
import { needsReason, reasonOf } from "./control";
import "./robots.css";

/** Before taking control: the person's name if it is not known, and of robots that somebody else controls, to ask or to take over. */
export function TakeOverDialog({ takeOver }: { takeOver: TakeOver }) {
  const { actions, rename } = useConsole();
  const [text, setText] = useState("");
  const [name, setName] = useState("");
  const { robots, from } = takeOver;
  const others = needsReason(takeOver);
  const reason = reasonOf(text);
  const act = async (take: () => Promise<unknown>) => {
    actions.closeDialog();
    if (name.trim() !== "") await rename(name);
    await take();
  };
  const submit = (event: Event) => {
    event.preventDefault();
    if (others) void act(() => actions.askForControl(robots, text.trim()));
    else void act(() => actions.takeControlNow(robots, ""));
  };
  return (
    <Modal title={others ? "Take over?" : `Take control of ${robots.join(", ")}?`}>
      <form class="dialog-form" onSubmit={submit}>
        {others && (
          <p>
            {from.join(", ")} {from.length === 1 ? "has" : "have"} control of {robots.join(", ")}.
          </p>
        )}
        <NameField name={name} onName={setName} />
        {others && <TextField label="Reason" limit={200} value={text} onValue={setText} />}
        <div class="row">
          <button type="submit" class="main">
            {others ? "Ask for control" : "Take control"}
          </button>
          {others && (
            <button
              type="button"
              disabled={reason === undefined}
              title="Without asking. They read your reason."
              onClick={() => void act(() => actions.takeControlNow(robots, reason ?? ""))}
            >
              Take over now
            </button>
          )}
          <button type="button" onClick={() => actions.closeDialog()}>
            Cancel
          </button>
        </div>
      </form>
    </Modal>
  );
}
