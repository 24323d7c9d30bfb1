// @vitest-environment happy-dom
import { beforeEach, describe, expect, it } from "vitest";
import { at, FakePage } from "./fixtures";
import { MapModel } from "./map_model";
import type { Tool } from "./map_props";
import { attachPointer } from "./pointer_input";
import { ToolDriver } from "./tool_driver";
import { cellCentre, type Point } from "./view";

let page: FakePage;
let model: MapModel;
let canvas: HTMLCanvasElement;

beforeEach(() => hold("look"));

function hold(tool: Tool): void {
  page = new FakePage({ tool });
  model = new MapModel(page.props);
  model.resize(400, 300);
  canvas = document.createElement("canvas");
  canvas.setPointerCapture = () => {};
  attachPointer(canvas, model, new ToolDriver(model), { held: false, used: false });
}

function point(name: string, pointerId: number, where: Point, pointerType = "touch"): void {
  dispatch(new PointerEvent(name, { pointerId, pointerType, button: 0 }), where);
}

function dispatch(event: MouseEvent, where: Point): void {
  Object.defineProperties(event, { offsetX: { value: where.x }, offsetY: { value: where.y } });
  canvas.dispatchEvent(event);
}

function view() {
  const now = model.view.peek();
  if (now === undefined) throw new Error("no view");
  return now;
}

const spot = (row: number, column: number) => cellCentre(view(), at(row, column));

describe("two fingers", () => {
  it("zoom and move the map, and the one that stays does nothing more", () => {
    const { scale } = view();
    point("pointerdown", 1, { x: 150, y: 150 });
    point("pointerdown", 2, { x: 250, y: 150 });
    point("pointermove", 2, { x: 300, y: 150 });
    expect(view().scale).toBeCloseTo(1.5 * scale);
    const zoomed = view();
    point("pointerup", 2, { x: 300, y: 150 });
    point("pointermove", 1, { x: 10, y: 10 });
    expect(view()).toEqual(zoomed);
    point("pointerup", 1, { x: 10, y: 10 });
    expect(page.asked).toEqual([]);
  });

  it("undo what the first one began to draw", () => {
    hold("wall");
    point("pointerdown", 1, spot(1, 3));
    expect(model.editing.peek()?.stroke?.size).toBe(1);
    point("pointerdown", 2, spot(3, 3));
    expect(model.editing.peek()?.stroke?.size ?? 0).toBe(0);
    point("pointerup", 1, spot(1, 3));
    point("pointerup", 2, spot(3, 3));
    expect(page.asked).toEqual([]);
  });
});

describe("one pointer", () => {
  it("draws where it is pressed", () => {
    hold("wall");
    point("pointerdown", 1, spot(1, 3), "mouse");
    point("pointerup", 1, spot(1, 3), "mouse");
    expect(page.asked).toMatchObject([{ kind: "edit", cells: [{ cell: at(1, 3), wall: true }] }]);
  });

  it("is on the cell that a drag or the wheel has brought there", () => {
    const there = spot(1, 3);
    point("pointerdown", 1, there, "mouse");
    point("pointermove", 1, { x: there.x + 70, y: there.y + 50 }, "mouse");
    expect(model.hover.peek()).toEqual(at(1, 3));
    point("pointerup", 1, there, "mouse");
    model.hover.value = undefined;
    dispatch(new WheelEvent("wheel", { deltaY: -100 }), spot(2, 2));
    expect(model.hover.peek()).toEqual(at(2, 2));
  });

  it("chooses the robot that it touches", () => {
    point("pointerdown", 1, spot(3, 5));
    point("pointerup", 1, spot(3, 5));
    expect(page.asked).toEqual([{ kind: "robot", name: "r2" }]);
  });
});
