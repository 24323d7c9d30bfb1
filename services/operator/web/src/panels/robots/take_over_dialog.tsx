import { useState } from "preact/hooks";
import { useConsole } from "../../app/console";
import { Modal } from "../../app/modal";
import type { TakeOver } from "../../state/store";
import { reasonOf } from "./control";
import "./robots.css";

/** Asks for a reason before taking control from somebody else. */
export function TakeOverDialog({ takeOver }: { takeOver: TakeOver }) {
  const { actions } = useConsole();
  const [text, setText] = useState("");
  const reason = reasonOf(text);
  const take = (event: Event) => {
    event.preventDefault();
    if (reason === undefined) return;
    void actions.takeControlNow(takeOver.robots, reason);
    actions.closeDialog();
  };
  return (
    <Modal title="Take over?">
      <form class="take-over" onSubmit={take}>
        <p>
          {takeOver.from.join(", ")} {takeOver.from.length === 1 ? "has" : "have"} control of{" "}
          {takeOver.robots.join(", ")}. They will read your reason.
        </p>
        <label>
          Reason
          <input
            type="text"
            maxLength={200}
            value={text}
            onInput={(event) => setText(event.currentTarget.value)}
          />
        </label>
        <div class="row">
          <button type="submit" class="main" disabled={reason === undefined}>
            Take over
          </button>
          <button type="button" onClick={() => actions.closeDialog()}>
            Cancel
          </button>
        </div>
      </form>
    </Modal>
  );
}
