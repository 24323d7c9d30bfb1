// Keys: those of the tools anywhere on the page, those of the cell cursor while the canvas has the focus.
import { CursorKeys, isArrow, type PanKey } from "./cursor_keys";
import type { Hand } from "./hand";
import type { MapModel } from "./map_model";
import { editsMap } from "./map_props";
import { PageKeys } from "./page_keys";
import { takesText } from "./takes_text";

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
  const isDriving = ({ key, shiftKey }: KeyboardEvent) => {
    const { arrowsDrive, tool } = model.props.peek();
    return arrowsDrive && !editsMap(tool) && !shiftKey && isArrow(key);
  };
  const onCanvas = (event: KeyboardEvent) => {
    if (event.defaultPrevented || event.altKey || event.metaKey || isDriving(event)) return;
    if (ofCursor.press(event)) event.preventDefault();
  };
  canvas.addEventListener("keydown", onCanvas, { signal });
  canvas.addEventListener("keyup", (event) => ofCursor.release(event), { signal });
  canvas.addEventListener("blur", () => ofCursor.leave(), { signal });
  window.addEventListener("keydown", onPage, { signal, capture: true });
  return () => ended.abort();
}

/** Somebody types, or a dialog is open: the keys are not the map's. */
function isBusy({ target }: KeyboardEvent): boolean {
  return takesText(target) || document.querySelector("dialog[open], [aria-modal=true]") !== null;
}
