// Pointer and wheel on the canvas.

import { contains } from "./grid";
import type { Hand } from "./hand";
import { markRadius } from "./layers/lanes";
import { robotPoint } from "./layers/robots";
import type { MapModel } from "./map_model";
import { cellAt, type Point, panBy } from "./view";

type Drag =
  | { kind: "pan"; last: Point; moved: number; robot: string | undefined }
  | { kind: "hand" };

/** `panKey` says whether the key that pans is held. The function that it returns ends the listening. */
export function attachPointer(
  canvas: HTMLCanvasElement,
  model: MapModel,
  hand: Hand,
  panKey: { held: boolean; used: boolean },
): () => void {
  const ended = new AbortController();
  const { signal } = ended;
  let drag: Drag | undefined;

  canvas.addEventListener("pointerdown", down, { signal });
  canvas.addEventListener("pointermove", move, { signal });
  canvas.addEventListener("pointerup", up, { signal });
  canvas.addEventListener("pointercancel", cancel, { signal });
  canvas.addEventListener("pointerleave", leave, { signal });
  canvas.addEventListener("dblclick", double, { signal });
  canvas.addEventListener("wheel", wheel, { signal, passive: false });
  return () => ended.abort();

  function pointOf(event: MouseEvent): Point {
    return { x: event.offsetX, y: event.offsetY };
  }

  function down(event: PointerEvent): void {
    const view = model.view.peek();
    if (!view || drag || event.button > 1) return;
    if (event.button === 1) event.preventDefault();
    canvas.setPointerCapture(event.pointerId);
    const at = pointOf(event);
    const cell = cellAt(view, at);
    const robot = robotAt(model, at);
    model.byKeyboard.value = false;
    if (contains(model.props.peek().world, cell)) model.cursor.value = cell;
    const pans = event.button === 1 || panKey.held;
    if (pans || model.props.peek().tool === "look") {
      panKey.used = true;
      drag = { kind: "pan", last: at, moved: 0, robot: pans ? undefined : robot };
    } else {
      drag = { kind: "hand" };
      hand.press(cell, { erase: event.shiftKey }, robot);
    }
  }

  function move(event: PointerEvent): void {
    const view = model.view.peek();
    if (!view) return;
    const at = pointOf(event);
    hover(cellAt(view, at));
    if (drag?.kind === "hand") hand.drag(cellAt(view, at));
    if (drag?.kind !== "pan") return;
    drag.moved += Math.hypot(at.x - drag.last.x, at.y - drag.last.y);
    if (drag.moved > 3) model.lookAt(panBy(view, at.x - drag.last.x, at.y - drag.last.y));
    drag.last = at;
  }

  function hover(cell: { row: number; column: number }): void {
    const before = model.hover.peek();
    if (before?.row === cell.row && before.column === cell.column) return;
    model.hover.value = contains(model.props.peek().world, cell) ? cell : undefined;
  }

  function up(): void {
    const done = drag;
    drag = undefined;
    if (done?.kind === "hand") hand.release();
    if (done?.kind === "pan" && done.moved <= 3 && done.robot !== undefined) {
      model.props.peek().onChooseRobot(done.robot);
    }
  }

  function cancel(): void {
    if (drag?.kind === "hand") hand.cancel();
    drag = undefined;
  }

  function leave(): void {
    model.hover.value = undefined;
  }

  function double(event: MouseEvent): void {
    const view = model.view.peek();
    if (view) hand.doublePress(cellAt(view, pointOf(event)));
  }

  function wheel(event: WheelEvent): void {
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
    const strength = event.ctrlKey ? 0.01 : 0.0015;
    model.zoom(Math.exp(-event.deltaY * lines * strength), pointOf(event));
  }
}

/** The robot whose mark is at the point; the one that is drawn last when several are. */
export function robotAt(model: MapModel, at: Point): string | undefined {
  const view = model.view.peek();
  if (!view) return undefined;
  const { robots, world } = model.props.peek();
  const hit = robots.filter((one) => {
    const mark = robotPoint(view, world, one);
    return Math.hypot(mark.x - at.x, mark.y - at.y) <= 1.25 * markRadius(view);
  });
  return hit.at(-1)?.robot.name;
}
