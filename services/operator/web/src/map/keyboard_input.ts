// Keys of the tools work anywhere on the page, keys of the cell cursor while the canvas has the focus.
import { CursorKeys, isArrow, type PanKey } from "./cursor_keys";
import { redo, undo } from "./edit_session";
import { focusMapIfNothing, takesText } from "./focus";
import { undoGoals } from "./goals";
import type { MapModel } from "./map_model";
import { editsMap, offers } from "./map_props";
import { hasDraft } from "./path/path_session";
import { solidKey, toolKeys } from "./shortcuts";
import type { ToolDriver } from "./tool_driver";

/** Prevents the default of keys that it handles, so that the page ignores them. Returns a function that detaches it. */
export function attachKeyboard(
  canvas: HTMLCanvasElement,
  model: MapModel,
  driver: ToolDriver,
  panKey: PanKey,
): () => void {
  const ended = new AbortController();
  const { signal } = ended;
  const ofPage = new PageKeys(model, driver);
  const ofCursor = new CursorKeys(model, driver, panKey);
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

/** Whether somebody types or a dialog is open. */
function isBusy({ target }: KeyboardEvent): boolean {
  return takesText(target) || document.querySelector("dialog[open], [aria-modal=true]") !== null;
}

/** Keys of the tools, anywhere on the page. */

export const zoomStep = 1.3;

class PageKeys {
  readonly #model: MapModel;
  readonly #driver: ToolDriver;

  constructor(model: MapModel, driver: ToolDriver) {
    this.#model = model;
    this.#driver = driver;
  }

  /** Returns whether the key was handled. */
  press(event: KeyboardEvent): boolean {
    const key = event.key.toLowerCase();
    if (event.altKey) return false;
    if (event.ctrlKey || event.metaKey) return this.#historyPressed(key, event.shiftKey);
    if (event.key === "Escape" && !event.shiftKey) return this.#escapePressed();
    const tool = event.shiftKey ? undefined : toolKeys.get(key);
    if (tool && !offers(this.#model.props.peek(), tool)) return false;
    if (tool) {
      this.#model.props.peek().onTool(tool);
      focusMapIfNothing(document);
    } else if (key === "+" || key === "=") this.#model.zoom(zoomStep);
    else if (key === "-") this.#model.zoom(1 / zoomStep);
    else if (key === "0") this.#model.showAll();
    else if (key === solidKey && !this.#model.props.peek().participates)
      this.#model.solid.value = !this.#model.solid.peek();
    else if (key === "l") this.#model.layersOpen.value = !this.#model.layersOpen.peek();
    else return false;
    return true;
  }

  #historyPressed(key: string, shift: boolean): boolean {
    const backwards = key === "z" && !shift;
    if (!backwards && key !== "y" && !(key === "z" && shift)) return false;
    if (this.#model.props.peek().tool === "goal") {
      if (backwards) void undoGoals(this.#model);
    } else if (this.#model.mayEdit()) this.#model.change(backwards ? undo : redo);
    return true;
  }

  /** Cancels the stroke, then the draft, then the tool. */
  #escapePressed(): boolean {
    const { tool, onTool } = this.#model.props.peek();
    if (this.#model.layersOpen.peek()) return false; // the menu closes
    if (this.#driver.busy) this.#driver.cancel();
    else if (hasPathDraft(this.#model)) this.#driver.leave();
    else if (tool !== "look") onTool("look");
    else return false;
    return true;
  }
}

/** Whether the chosen robot has an unsent path. */
export function hasPathDraft(model: MapModel): boolean {
  const session = model.paths.peek().get(model.props.peek().chosenRobot ?? "");
  return session !== undefined && hasDraft(session);
}
