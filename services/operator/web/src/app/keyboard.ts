import { inTask } from "../panels/task/task_keys";
import type { Teleoperation } from "../panels/teleoperation/teleoperation";
import { DriveAction, Mode } from "../protocol/generated/console_pb";
import type { Store } from "../state/store";
import { type Commands, commandOf, keyOf } from "./shortcuts";

const driveKeys: ReadonlyMap<string, DriveAction> = new Map([
  ["ArrowUp", DriveAction.DRIVE_FORWARD],
  ["ArrowDown", DriveAction.DRIVE_BACKWARD],
  ["ArrowLeft", DriveAction.DRIVE_TURN_LEFT],
  ["ArrowRight", DriveAction.DRIVE_TURN_RIGHT],
]);

/**
 * Listens on the whole page. What somebody else has dealt with, such as the map, is left alone. The function that it returns
 * ends the listening.
 */
export function listenToKeys(
  page: Window,
  store: Store,
  commands: Commands,
  driving: Teleoperation,
): () => void {
  const ended = new AbortController();
  const { signal } = ended;
  page.addEventListener("keydown", keyDown, { signal });
  page.addEventListener("keyup", keyUp, { signal });
  page.addEventListener("blur", () => driving.halt(), { signal });
  page.document.addEventListener("visibilitychange", hidden, { signal });
  return () => ended.abort();

  function keyDown(event: KeyboardEvent): void {
    if (event.defaultPrevented) return;
    const place = event.target instanceof Element ? event.target : undefined;
    if (pressed(event, place)) event.preventDefault();
  }

  function keyUp({ key }: KeyboardEvent): void {
    const action = driveKeys.get(key);
    if (action !== undefined) driving.release(action);
  }

  function hidden(): void {
    if (page.document.hidden) driving.halt();
  }

  function pressed(event: KeyboardEvent, place: Element | undefined): boolean {
    const busy = store.dialog.value !== undefined || typesIn(place);
    const action = driveKeys.get(keyOf(event) ?? "");
    if (action !== undefined && store.state.value.session?.drives && !busy && !arrowsIn(place)) {
      driving.press(action);
      return true;
    }
    const replay = store.state.value.welcome?.mode === Mode.REPLAY;
    const onControl =
      (place?.closest("button, summary, a, select, input") ?? undefined) !== undefined;
    const meant = commandOf(event, { replay, busy, onControl });
    const command = inTask(store.state.value, meant);
    if (command === undefined || (event.repeat && !mayRepeat(command))) return false;
    commands[command]();
    return true;
  }
}

/** A key that is held down must not ask for the same again and again, but for turning pages. */
function mayRepeat(command: string): boolean {
  return command.endsWith("picture");
}

function typesIn(place: Element | undefined): boolean {
  return place?.matches("input:not([type=range]), textarea, [contenteditable=true]") ?? false;
}

function arrowsIn(place: Element | undefined): boolean {
  return place?.matches("input, select, textarea") ?? false;
}
