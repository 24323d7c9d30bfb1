import { X } from "lucide-preact";
import type { ComponentChildren } from "preact";
import { useEffect, useId, useRef } from "preact/hooks";
import { focusMapIfNothing } from "../map/focus";
import { useConsole } from "./console";

interface Props {
  title: string;
  /** A dialog to read: it opens at its top, with the focus on the text. */
  toRead?: boolean;
  children: ComponentChildren;
}

/** The browser's own dialog, which traps the focus and restores it; the map gets it where nothing had it. */
export function Modal({ title, toRead = false, children }: Props) {
  const { actions } = useConsole();
  const dialog = useRef<HTMLDialogElement>(null);
  const heading = useId();
  useEffect(() => {
    const shown = dialog.current;
    if (!shown) return undefined;
    shown.showModal();
    if (toRead) {
      shown.focus();
      shown.scrollTo(0, 0);
    }
    // Reports that the browser closed the dialog, but not that it was unmounted.
    const mounted = new AbortController();
    shown.addEventListener("close", () => actions.closeDialog(), { signal: mounted.signal });
    return () => {
      mounted.abort();
      shown.close();
      focusMapIfNothing(document);
    };
  }, [actions, toRead]);
  return (
    <dialog ref={dialog} class="modal" tabIndex={-1} aria-labelledby={heading}>
      <h2 id={heading}>{title}</h2>
      {children}
      {/* Last, so that the content gets the focus first. */}
      <button type="button" class="close" onClick={() => actions.closeDialog()} aria-label="Close">
        <X size={16} />
      </button>
    </dialog>
  );
}
