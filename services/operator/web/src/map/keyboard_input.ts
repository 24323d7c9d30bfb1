// Keys: those of the tools anywhere on the page, those of the cell cursor while the canvas has the focus.
import { CursorKeys, type PanKey } from "./cursor_keys";
import type { Hand } from "./hand";
import type { MapModel } from "./map_model";
import { PageKeys } from "./page_keys";

/** Keys that it has dealt with are prevented, so that the page leaves them alone. The function that it returns ends it. */
export function attachKeyboard(
  canvas: HTMLCanvasElement,
  model: MapModel,
  hand: Hand,
  panKey: PanKey,
): () => void {
  const ended = new AbortController();
  const { signal } = ended;
  const ofPage = new PageKeys(model, hand);
  const ofCursor = new CursorKeys(model, hand, panKey);
  const onPage = (event: KeyboardEvent) => {
    if (event.defaultPrevented || isBusy(event)) return;
    if (ofPage.press(event)) event.preventDefault();
  };
  const onCanvas = (event: KeyboardEvent) => {
    if (event.defaultPrevented || event.altKey || event.metaKey) return;
    if (ofCursor.press(event)) event.preventDefault();
  };
  canvas.addEventListener("keydown", onCanvas, { signal });
  canvas.addEventListener("keyup", (event) => ofCursor.release(event), { signal });
  canvas.addEventListener("blur", () => ofCursor.leave(), { signal });
  window.addEventListener("keydown", onPage, { signal, capture: true });
  return () => ended.abort();
}

/** Somebody types, or a dialog is open: the keys are not the map's. */
function isBusy(event: KeyboardEvent): boolean {
  const place = event.target instanceof Element ? event.target : undefined;
  const types = place?.matches(
    "input:not([type=checkbox], [type=range]), select, textarea, [contenteditable=true]",
  );
  return types === true || document.querySelector("dialog[open], [aria-modal=true]") !== null;
}
