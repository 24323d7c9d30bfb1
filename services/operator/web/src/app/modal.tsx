import type { ComponentChildren } from "preact";
import { useEffect, useId, useRef } from "preact/hooks";
import "./modal.css";

interface Props {
  title: string;
  onClose: () => void;
  /** There is nothing to do first: the focus is on the text, which shows its beginning. */
  toRead?: boolean;
  children: ComponentChildren;
}

/** The browser's own dialog: it keeps the focus, and gives it back. */
export function Modal({ title, onClose, toRead = false, children }: Props) {
  const dialog = useRef<HTMLDialogElement>(null);
  const heading = useId();
  const close = useRef(onClose);
  close.current = onClose;
  useEffect(() => {
    const shown = dialog.current;
    if (!shown) return undefined;
    shown.showModal();
    if (toRead) {
      shown.focus();
      shown.scrollTo(0, 0);
    }
    // Whichever way the browser closes it; but not when it goes because we have closed it.
    const mounted = new AbortController();
    shown.addEventListener("close", () => close.current(), { signal: mounted.signal });
    return () => {
      mounted.abort();
      shown.close();
    };
  }, [toRead]);
  return (
    <dialog ref={dialog} class="modal" tabIndex={-1} aria-labelledby={heading}>
      <h2 id={heading}>{title}</h2>
      {children}
      {/* Last, so that the focus begins at what the dialog is about. */}
      <button type="button" class="close" onClick={onClose} aria-label="Close">
        ✕
      </button>
    </dialog>
  );
}
