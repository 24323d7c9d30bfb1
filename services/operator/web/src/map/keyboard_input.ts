// Keys: those of the tools anywhere on the page, those of the cell cursor while the canvas has the focus.
import { redo, undo } from "./edit/edit_session";
import { clampCell } from "./grid";
import type { Hand } from "./hand";
import type { MapModel } from "./map_model";
import type { Cell } from "./map_props";
import { hasDraft } from "./path/path_session";
import { toolKeys } from "./shortcuts";
import { cellAt, panBy } from "./view";

const arrows: ReadonlyMap<string, Cell> = new Map([
  ["ArrowUp", { row: -1, column: 0 }],
  ["ArrowDown", { row: 1, column: 0 }],
  ["ArrowLeft", { row: 0, column: -1 }],
  ["ArrowRight", { row: 0, column: 1 }],
]);

export const zoomStep = 1.3;

/** Keys that it has dealt with are prevented, so that the page leaves them alone. The function that it returns ends it. */
export function attachKeyboard(
  canvas: HTMLCanvasElement,
  model: MapModel,
  hand: Hand,
  panKey: { held: boolean; used: boolean },
): () => void {
  const ended = new AbortController();
  const { signal } = ended;
  canvas.addEventListener("keydown", onCanvas, { signal });
  canvas.addEventListener("keyup", keyUp, { signal });
  canvas.addEventListener("blur", blur, { signal });
  window.addEventListener("keydown", onPage, { signal, capture: true });
  return () => ended.abort();

  function onPage(event: KeyboardEvent): void {
    if (event.defaultPrevented || isBusy(event)) return;
    if (pagePressed(event)) event.preventDefault();
  }

  function pagePressed(event: KeyboardEvent): boolean {
    const key = event.key.toLowerCase();
    if (event.altKey) return false;
    if (event.ctrlKey || event.metaKey) return historyPressed(key, event.shiftKey);
    if (event.key === "Escape" && !event.shiftKey) return escapePressed();
    const tool = event.shiftKey ? undefined : toolKeys.get(key);
    if (tool) model.props.peek().onTool(tool);
    else if (key === "+" || key === "=") model.zoom(zoomStep);
    else if (key === "-") model.zoom(1 / zoomStep);
    else if (key === "0") model.showAll();
    else if (key === "l") model.layersOpen.value = !model.layersOpen.peek();
    else return false;
    return true;
  }

  function historyPressed(key: string, shift: boolean): boolean {
    const backwards = key === "z" && !shift;
    if (!backwards && key !== "y" && !(key === "z" && shift)) return false;
    if (model.mayEdit()) model.change(backwards ? undo : redo);
    return true;
  }

  /** First what is being drawn, then the draft, then the tool. */
  function escapePressed(): boolean {
    const { tool, onTool } = model.props.peek();
    if (model.layersOpen.peek()) return false; // the menu closes
    if (hand.busy) hand.cancel();
    else if (draft()) hand.leave();
    else if (tool !== "look") onTool("look");
    else return false;
    return true;
  }

  function draft(): boolean {
    const session = model.paths.peek().get(model.props.peek().chosenRobot ?? "");
    return session !== undefined && hasDraft(session);
  }

  function onCanvas(event: KeyboardEvent): void {
    if (event.defaultPrevented || event.altKey || event.metaKey) return;
    if (canvasPressed(event)) event.preventDefault();
  }

  function canvasPressed(event: KeyboardEvent): boolean {
    const by = arrows.get(event.key);
    if (by && event.shiftKey) pan(by);
    else if (by) moveTo((cell) => ({ row: cell.row + by.row, column: cell.column + by.column }));
    else if (event.key === "Home") moveTo((cell) => homeOf(cell, event.ctrlKey));
    else if (event.key === "End") moveTo((cell) => endOf(cell, event.ctrlKey));
    else if (event.key === " ") panKey.held = true;
    else if (event.key === "Enter") enter(event.shiftKey);
    else if (event.key === "Delete" || event.key === "Backspace") remove();
    else return false;
    return true;
  }

  function keyUp(event: KeyboardEvent): void {
    if (event.key !== " " || !panKey.held) return;
    if (!panKey.used) apply(event.shiftKey);
    panKey.held = false;
    panKey.used = false;
  }

  function blur(): void {
    panKey.held = false;
    model.byKeyboard.value = false;
  }

  function pan(by: Cell): void {
    const view = model.view.peek();
    if (view) model.lookAt(panBy(view, -60 * by.column, -60 * by.row));
  }

  /** The first key only shows where the cursor is. */
  function moveTo(target: (cell: Cell) => Cell): void {
    const { world } = model.props.peek();
    const cursor = model.cursor.peek();
    const shown = model.byKeyboard.peek() && cursor !== undefined;
    const from = cursor ?? startCell();
    model.moveCursor(clampCell(world, shown ? target(from) : from));
  }

  /** In the chosen robot's cell, or in the middle of what is in sight. */
  function startCell(): Cell {
    const { robots, chosenRobot } = model.props.peek();
    const robot = robots.find((one) => one.robot.name === chosenRobot)?.robot.cell;
    const view = model.view.peek();
    if (robot || !view) return robot ?? { row: 0, column: 0 };
    return cellAt(view, { x: view.width / 2, y: view.height / 2 });
  }

  function homeOf(cell: Cell, all: boolean): Cell {
    return { row: all ? 0 : cell.row, column: 0 };
  }

  function endOf(cell: Cell, all: boolean): Cell {
    const { rows, columns } = model.props.peek().world;
    return { row: all ? rows - 1 : cell.row, column: columns - 1 };
  }

  function enter(shift: boolean): void {
    if (model.props.peek().tool === "path" && draft()) hand.send();
    else apply(shift);
  }

  function apply(shift: boolean): void {
    const cursor = model.cursor.peek();
    if (!cursor || !model.byKeyboard.peek()) {
      moveTo((cell) => cell);
      return;
    }
    if (model.props.peek().tool === "look") chooseRobotIn(cursor);
    else hand.apply(cursor, { erase: shift });
  }

  function chooseRobotIn(cell: Cell): void {
    const { robots, onChooseRobot } = model.props.peek();
    const here = robots.find(
      ({ robot }) => robot.cell?.row === cell.row && robot.cell.column === cell.column,
    );
    if (here) onChooseRobot(here.robot.name);
  }

  function remove(): void {
    if (model.props.peek().tool !== "path") return;
    const cursor = model.cursor.peek();
    const session = model.paths.peek().get(model.props.peek().chosenRobot ?? "");
    const onPath = session?.cells.some(
      (cell) => cell.row === cursor?.row && cell.column === cursor.column,
    );
    hand.removeVertex(onPath ? cursor : undefined);
  }
}

/** Somebody types, or a dialog is open: the keys are not the map's. */
function isBusy(event: KeyboardEvent): boolean {
  const place = event.target instanceof Element ? event.target : undefined;
  const types = place?.matches(
    "input:not([type=checkbox], [type=range]), select, textarea, [contenteditable=true]",
  );
  return types === true || document.querySelector("dialog[open], [aria-modal=true]") !== null;
}
