// @vitest-environment happy-dom
import { create } from "@bufbuild/protobuf";
import fc from "fast-check";
import { beforeEach, describe, expect, it } from "vitest";
import { WorldSchema } from "../protocol/generated/console_pb";
import { at, beliefOf, FakePage, robotIn } from "./fixtures";
import { clampCell, sameCell } from "./grid";
import { MapModel } from "./map_model";
import type { Cell, MapProps, Tool } from "./map_props";
import { attachPointer } from "./pointer_input";
import { ToolDriver } from "./tool_driver";
import { cellCentre, type Point } from "./view";

let page: FakePage;
let model: MapModel;
let canvas: HTMLCanvasElement;

beforeEach(() => hold("look"));

function hold(tool: Tool, more: Partial<MapProps> = {}): void {
  page = new FakePage({ tool, ...more });
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

describe("the path tool near moving robots", () => {
  const size = { rows: 9, columns: 9 };
  const rows = Array.from({ length: size.rows }, () => ".".repeat(size.columns));
  const open = {
    world: create(WorldSchema, { name: "w1", ...size, cellSize: 2 }),
    belief: beliefOf(rows, 3n),
  };
  // The grid's middle is the origin of a world, and robotIn() counts from that of the small one.
  const standing = (name: string, cell: Cell) => {
    const one = robotIn(name, cell);
    const x = 2 * (cell.column + 0.5 - size.columns / 2);
    const y = 2 * (size.rows / 2 - cell.row - 0.5);
    return { ...one, robot: { ...one.robot, x, y } };
  };
  const near = fc.record({
    row: fc.integer({ min: -2, max: 2 }),
    column: fc.integer({ min: -2, max: 2 }),
  });
  const offset = fc.oneof(fc.constant(at(0, 0)), near);
  const direction = fc.constantFrom(at(0, 1), at(1, 0), at(0, -1), at(-1, 0));
  const one = (kind: string, by: fc.Arbitrary<Cell>) =>
    fc.record({ kind: fc.constant(kind), robot: fc.nat(1), by });
  const step = fc.oneof(
    { weight: 2, arbitrary: one("press", offset) },
    { weight: 4, arbitrary: one("drag", direction) },
    { weight: 1, arbitrary: one("move", direction) },
    { weight: 2, arbitrary: one("release", direction) },
  );

  it("sends nothing that the hand did not draw from that robot", () => {
    let sent = 0;
    const play = (steps: readonly { kind: string; robot: number; by: Cell }[]) => {
      hold("path", { ...open, robots: [standing("r1", at(2, 2)), standing("r2", at(6, 6))] });
      let hand: Cell | undefined;
      const drawn = new Map<string, Cell[]>();
      let begun: string | undefined;
      for (const { kind, robot, by } of steps) {
        const before = page.asked.length;
        const cells = page.props.robots.map((one) => one.robot.cell ?? at(0, 0));
        const plus = (cell: Cell) =>
          clampCell(size, at(cell.row + by.row, cell.column + by.column));
        if (kind === "press" && hand === undefined) {
          hand = plus(cells[robot] ?? at(0, 0));
          const pressed = page.props.robots.findLast((one) => sameCell(one.robot.cell, hand));
          const ends = [...model.paths.peek().values()].find((path) =>
            sameCell(path.cells.at(-1), hand),
          );
          begun = pressed?.robot.name ?? ends?.robot;
          if (begun !== undefined)
            drawn.set(begun, [...(pressed ? [] : (drawn.get(begun) ?? [])), hand]);
          point("pointerdown", 1, spot(hand.row, hand.column), "mouse");
        } else if (kind === "drag" && hand) {
          hand = plus(hand);
          drawn.get(begun ?? "")?.push(hand);
          point("pointermove", 1, spot(hand.row, hand.column), "mouse");
        } else if (kind === "move") {
          const robots = page.props.robots.map((one, i) =>
            i === robot ? standing(one.robot.name, plus(cells[i] ?? at(0, 0))) : one,
          );
          page.props = { ...page.props, robots };
          model.update(page.props);
        } else if (kind === "release" && hand) {
          point("pointerup", 1, spot(hand.row, hand.column), "mouse");
          hand = undefined;
        }
        for (const asked of page.asked.slice(before)) {
          if (asked.kind !== "path") continue;
          sent += 1;
          expect(asked.robot).toBe(begun);
          const start = page.props.robots.find((one) => one.robot.name === begun)?.robot.cell;
          expect(asked.cells[0]).toMatchObject({ row: start?.row, column: start?.column });
          for (const cell of asked.cells.slice(1)) {
            expect(drawn.get(asked.robot)?.some((other) => sameCell(other, cell))).toBe(true);
          }
        }
      }
    };
    fc.assert(fc.property(fc.array(step, { minLength: 20, maxLength: 60 }), play), {
      numRuns: 200,
    });
    expect(sent).toBeGreaterThan(100);
  });
});
