import { focusMapIfNothing, takesText } from "../map/focus";
import { editsMap } from "../map/map_props";
import type { Teleoperation } from "../panels/robots/teleoperation";
import { inTask } from "../panels/task/task_keys";
import { DriveAction, Mode } from "../protocol/generated/console_pb";
import type { Store } from "../state/store";
import { type CommandName, type Commands, commandOf, keyOf } from "./shortcuts";

const driveKeys: ReadonlyMap<string, DriveAction> = new Map([
  ["ArrowUp", DriveAction.DRIVE_FORWARD],
  ["ArrowDown", DriveAction.DRIVE_BACKWARD],
  ["ArrowLeft", DriveAction.DRIVE_TURN_LEFT],
  ["ArrowRight", DriveAction.DRIVE_TURN_RIGHT],
]);

/**
 * Listens to keys on the whole page and ignores events that somebody else, such as the map, has handled. Returns a function that
 * stops listening.
 *
 * Driving ends when the key is released, and on every event that may hide the release: lost focus, hidden page, context menu,
 * drag, Ctrl, Alt or Meta. It starts with a new press only, never with a repeated key.
 */
export function listenToKeys(
  page: Window,
  store: Store,
  commands: Commands,
  driving: Teleoperation,
): () => void {
  const ended = new AbortController();
  const { signal } = ended;
  /** By physical key: its character may change while it is held, as with Num Lock. */
  const held = new Map<string, DriveAction>();
  page.addEventListener("keydown", keyDown, { signal });
  page.addEventListener("keyup", keyUp, { signal });
  page.addEventListener("blur", halt, { signal });
  page.addEventListener("contextmenu", halt, { signal });
  page.addEventListener("dragstart", halt, { signal });
  page.document.addEventListener("visibilitychange", hidden, { signal });
  return () => ended.abort();

  function keyDown(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey) halt();
    if (event.defaultPrevented) return;
    const place = event.target instanceof Element ? event.target : undefined;
    if (pressed(event, place)) event.preventDefault();
  }

  function keyUp(event: KeyboardEvent): void {
    const action = held.get(physicalKey(event));
    held.delete(physicalKey(event));
    if (action !== undefined && ![...held.values()].includes(action)) driving.release(action);
  }

  function halt(): void {
    held.clear();
    driving.halt();
  }

  function hidden(): void {
    if (page.document.hidden) halt();
  }

  function drive(event: KeyboardEvent, action: DriveAction): void {
    if (event.repeat) return;
    held.set(physicalKey(event), action);
    driving.press(action);
  }

  function pressed(event: KeyboardEvent, place: Element | undefined): boolean {
    const busy = store.dialog.value !== undefined || takesText(event.target);
    const action = driveKeys.get(keyOf(event) ?? "");
    if (action !== undefined && arrowsDrive(store) && !busy && !arrowsIn(place)) {
      drive(event, action);
      return true;
    }
    const replay = store.state.value.welcome?.mode === Mode.REPLAY;
    const onControl = place !== undefined && place.closest(controls) !== null;
    const meant = commandOf(event, { replay, busy, onControl });
    const command = inTask(store.state.value, meant);
    if (command === undefined || (event.repeat && !repeating.has(command))) return false;
    commands[command]();
    if (command === "next") focusMapIfNothing(page.document);
    return true;
  }
}

const controls = "button, summary, a, select, input";

/** The physical key; its character if the browser does not report the key. */
function physicalKey({ code, key }: KeyboardEvent): string {
  return code || key;
}

/** Commands that repeat while their key is held. */
const repeating: ReadonlySet<CommandName> = new Set(["older picture", "newer picture"]);

/** While the map is edited the arrow keys move its cursor instead. */
function arrowsDrive({ state, tool }: Store): boolean {
  return state.value.session?.drives === true && !editsMap(tool.value);
}

function arrowsIn(place: Element | undefined): boolean {
  return place?.matches("input:not([type=checkbox]), select, textarea") ?? false;
}
