import { X } from "lucide-preact";
import { withNames } from "../state/selectors";
import { useConsole } from "./console";

/** Short messages, mostly about refused requests. */
export function Notices() {
  const { store, actions } = useConsole();
  return (
    <output class="notices" aria-atomic="false">
      {store.notices.value.map(({ id, text, kind }) => (
        <span key={id} class={kind}>
          {kind === "problem" ? "▲ " : ""}
          {withNames(store.state.value, text)}
          <button type="button" aria-label="Dismiss" onClick={() => actions.dismiss(id)}>
            <X size={14} />
          </button>
        </span>
      ))}
    </output>
  );
}
