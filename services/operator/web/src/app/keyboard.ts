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
 * Listens on the whole page. What somebody else has dealt with, such as the map, is left alone. The function that it returns
 * ends the listening.
 *
 * Driving ends with the key, and with whatever may keep us from hearing of its release: focus or page lost, a context menu, something
 * that is dragged, Ctrl, Alt or Meta. It begins with a new press only, never by a key that repeats because it is still held.
 */
export function listenToKeys(
  page: Window,
  store: Store,
  commands: Commands,
  driving: Teleoperation,
): () => void {
  const ended = new AbortController();
  const { signal } = ended;
  /** By the key itself: what it writes may change while it is held, as with Num Lock. */
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

/** Which key of the keyboard it is; what it writes where that is not told. */
function physicalKey({ code, key }: KeyboardEvent): string {
  return code || key;
}

/** A key that is held down must not ask for the same again and again, but for turning pages. */
const repeating: ReadonlySet<CommandName> = new Set(["older picture", "newer picture"]);

/** Who edits the map moves its cursor by them. */
function arrowsDrive({ state, tool }: Store): boolean {
  return state.value.session?.drives === true && !editsMap(tool.value);
}

function arrowsIn(place: Element | undefined): boolean {
  return place?.matches("input:not([type=checkbox]), select, textarea") ?? false;
}
