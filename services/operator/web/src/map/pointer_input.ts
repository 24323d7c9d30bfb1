// Pointer and wheel on the canvas.

import type { PanKey } from "./cursor_keys";
import { contains, sameCell } from "./grid";
import { markRadius } from "./layers/paths";
import { robotPoint } from "./layers/robots";
import type { MapModel } from "./map_model";
import type { ToolDriver } from "./tool_driver";
import { cellAt, type Point, panBy, pinch, type TwoPoints, type View } from "./view";

type Drag =
  | { kind: "pan"; last: Point; moved: number; robot: string | undefined }
  | { kind: "pinch"; last: TwoPoints }
  | { kind: "tool" };

/** `panKey`: whether Space is held. Returns a function that detaches it. */
export function attachPointer(
  canvas: HTMLCanvasElement,
  model: MapModel,
  driver: ToolDriver,
  panKey: PanKey,
): () => void {
  const ended = new AbortController();
  const { signal } = ended;
  const pointer = new Pointer(canvas, model, driver, panKey);
  canvas.addEventListener("pointerdown", (event) => pointer.down(event), { signal });
  canvas.addEventListener("pointermove", (event) => pointer.move(event), { signal });
  canvas.addEventListener("pointerup", (event) => pointer.up(event), { signal });
  canvas.addEventListener("pointercancel", (event) => pointer.cancel(event), { signal });
  canvas.addEventListener("pointerleave", () => pointer.leave(), { signal });
  canvas.addEventListener("dblclick", (event) => pointer.double(event), { signal });
  canvas.addEventListener("wheel", (event) => pointer.wheel(event), { signal, passive: false });
  return () => ended.abort();
}

class Pointer {
  readonly #canvas: HTMLCanvasElement;
  readonly #model: MapModel;
  readonly #driver: ToolDriver;
  readonly #panKey: PanKey;
  #drag: Drag | undefined;
  /** Positions of the pointers that are down: the mouse, or each finger. */
  readonly #down = new Map<number, Point>();

  constructor(canvas: HTMLCanvasElement, model: MapModel, driver: ToolDriver, panKey: PanKey) {
    this.#canvas = canvas;
    this.#model = model;
    this.#driver = driver;
    this.#panKey = panKey;
  }

  down(event: PointerEvent): void {
    const view = this.#model.view.peek();
    if (!view || event.button > 1) return;
    const at = pointOf(event);
    if (this.#down.size > 0) {
      this.#secondDown(event, at);
      return;
    }
    if (event.button === 1) event.preventDefault();
    this.#canvas.setPointerCapture(event.pointerId);
    this.#down.set(event.pointerId, at);
    const cell = cellAt(view, at);
    const robot = robotAt(this.#model, at);
    this.#model.byKeyboard.value = false;
    if (contains(this.#model.props.peek().world, cell)) this.#model.cursor.value = cell;
    const pans = event.button === 1 || this.#panKey.held;
    if (pans || this.#model.props.peek().tool === "look") {
      this.#panKey.used = true;
      this.#drag = { kind: "pan", last: at, moved: 0, robot: pans ? undefined : robot };
    } else {
      this.#drag = { kind: "tool" };
      this.#driver.press(cell, { erase: event.shiftKey }, robot);
    }
  }

  /** Two fingers move the map with any tool and cancel the first finger's stroke. A third finger does nothing. */
  #secondDown({ pointerId, pointerType }: PointerEvent, at: Point): void {
    const [first, another] = [...this.#down.values()];
    if (pointerType !== "touch" || first === undefined || another !== undefined) return;
    if (this.#drag?.kind === "tool") this.#driver.cancel();
    this.#canvas.setPointerCapture(pointerId);
    this.#down.set(pointerId, at);
    this.#drag = { kind: "pinch", last: [first, at] };
    this.#model.hover.value = undefined;
  }

  #pinchTo(view: View): void {
    const [first, second] = [...this.#down.values()];
    if (this.#drag?.kind !== "pinch" || first === undefined || second === undefined) return;
    const now: TwoPoints = [first, second];
    this.#model.lookAt(pinch(view, this.#drag.last, now));
    this.#drag.last = now;
  }

  move(event: PointerEvent): void {
    const view = this.#model.view.peek();
    if (!view) return;
    const at = pointOf(event);
    if (this.#down.has(event.pointerId)) this.#down.set(event.pointerId, at);
    if (this.#drag?.kind === "pinch") {
      this.#pinchTo(view);
      return;
    }
    if (this.#drag?.kind === "pan") this.#panTo(this.#drag, view, at);
    this.#hover(at);
    if (this.#drag?.kind === "tool") this.#driver.drag(cellAt(view, at));
  }

  #panTo(drag: Drag & { kind: "pan" }, view: View, at: Point): void {
    drag.moved += Math.hypot(at.x - drag.last.x, at.y - drag.last.y);
    if (drag.moved > 3) this.#model.lookAt(panBy(view, at.x - drag.last.x, at.y - drag.last.y));
    drag.last = at;
  }

  /** Of the view as it is now, after a pan or zoom. */
  #hover(at: Point): void {
    const view = this.#model.view.peek();
    if (!view) return;
    const cell = cellAt(view, at);
    if (sameCell(this.#model.hover.peek(), cell)) return;
    this.#model.hover.value = contains(this.#model.props.peek().world, cell) ? cell : undefined;
  }

  up({ pointerId }: PointerEvent): void {
    if (!this.#down.delete(pointerId)) return;
    const done = this.#drag;
    // The remaining finger must not draw.
    if (done?.kind === "pinch" && this.#down.size > 0) return;
    this.#drag = undefined;
    if (done?.kind === "tool") this.#driver.release();
    if (done?.kind === "pan" && done.moved <= 3 && done.robot !== undefined) {
      this.#model.props.peek().onChooseRobot(done.robot);
    }
  }

  cancel({ pointerId }: PointerEvent): void {
    if (!this.#down.delete(pointerId)) return;
    if (this.#drag?.kind === "tool") this.#driver.cancel();
    if (this.#down.size === 0) this.#drag = undefined;
  }

  leave(): void {
    this.#model.hover.value = undefined;
  }

  double(event: MouseEvent): void {
    const view = this.#model.view.peek();
    if (view) this.#driver.doublePress(cellAt(view, pointOf(event)));
  }

  wheel(event: WheelEvent): void {
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
    const strength = event.ctrlKey ? 0.01 : 0.0015;
    this.#model.zoom(Math.exp(-event.deltaY * lines * strength), pointOf(event));
    this.#hover(pointOf(event));
  }
}

function pointOf(event: MouseEvent): Point {
  return { x: event.offsetX, y: event.offsetY };
}

/** The robot whose mark is at the point; the topmost if there are several. */
function robotAt(model: MapModel, at: Point): string | undefined {
  const view = model.view.peek();
  if (!view) return undefined;
  const { robots, world } = model.props.peek();
  const hit = robots.filter((one) => {
    const mark = robotPoint(view, world, one);
    return Math.hypot(mark.x - at.x, mark.y - at.y) <= 1.25 * markRadius(view);
  });
  return hit.at(-1)?.robot.name;
}
