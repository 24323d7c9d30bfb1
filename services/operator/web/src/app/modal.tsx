import type { ComponentChildren } from "preact";
import { useEffect, useId, useRef } from "preact/hooks";
import { useConsole } from "./console";

interface Props {
  title: string;
  /** There is nothing to do first: the focus is on the text, which shows its beginning. */
  toRead?: boolean;
  children: ComponentChildren;
}

/** The browser's own dialog: it keeps the focus, and gives it back. */
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
    // By whichever way the browser closes it; not when it goes because it was closed.
    const mounted = new AbortController();
    shown.addEventListener("close", () => actions.closeDialog(), { signal: mounted.signal });
    return () => {
      mounted.abort();
      shown.close();
    };
  }, [actions, toRead]);
  return (
    <dialog ref={dialog} class="modal" tabIndex={-1} aria-labelledby={heading}>
      <h2 id={heading}>{title}</h2>
      {children}
      {/* Last, so that the focus begins at what the dialog is about. */}
      <button type="button" class="close" onClick={() => actions.closeDialog()} aria-label="Close">
        ✕
      </button>
    </dialog>
  );
}
