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
  useEffect(() => {
    dialog.current?.showModal();
    if (toRead) {
      dialog.current?.focus();
      dialog.current?.scrollTo(0, 0);
    }
    return () => dialog.current?.close();
  }, []);
  return (
    <dialog ref={dialog} class="modal" tabIndex={-1} aria-labelledby={heading} onCancel={onClose}>
      <h2 id={heading}>{title}</h2>
      {children}
      {/* Last, so that the focus begins at what the dialog is about. */}
      <button type="button" class="close" onClick={onClose} aria-label="Close">
        ✕
      </button>
    </dialog>
  );
}
