import { create } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { GuidanceSchema, SeenMapSchema, WorldSchema } from "../protocol/generated/console_pb";
import { at, beliefOf, FakePage, robotIn, worldRows } from "./fixtures";
import { sameCell, wallCell } from "./grid";
import { MapModel } from "./map_model";
import type { Cell, MapProps } from "./map_props";
import { ToolDriver } from "./tool_driver";

function start(more: Partial<MapProps> = {}) {
  const page = new FakePage(more);
  const model = new MapModel(page.props);
  const driver = new ToolDriver(model);
  const drag = (first: Cell, ...rest: Cell[]) => {
    const robot = page.props.robots.find((one) => sameCell(one.robot.cell, first));
    driver.press(first, { erase: false }, robot?.robot.name);
    for (const cell of rest) driver.drag(cell);
    driver.release();
  };
  const update = (changed: Partial<MapProps>) => {
    page.props = { ...page.props, ...changed };
    model.update(page.props);
  };
  return { page, model, driver, drag, update };
}

const settle = () => new Promise<void>((done) => setTimeout(done));

describe("the brush", () => {
  it("sends the line that it was dragged over, as one edit", () => {
    const { page, drag } = start({ tool: "wall" });
    drag(at(1, 2), at(1, 4));
    expect(page.asked).toEqual([
      {
        kind: "edit",
        world: "w1",
        base: 3n,
        cells: [2, 3, 4].map((column) => ({ cell: at(1, column), wall: true })),
      },
    ]);
  });

  it("erases with its tool, or with Shift", () => {
    const erasing = start({ tool: "erase" });
    erasing.drag(at(2, 2));
    const shifted = start({ tool: "wall" });
    shifted.driver.press(at(2, 2), { erase: true });
    shifted.driver.release();
    for (const { page } of [erasing, shifted]) {
      expect(page.asked).toMatchObject([{ cells: [{ cell: at(2, 2), wall: false }] }]);
    }
  });

  it("shows a note when editing is forbidden, and on the border", () => {
    const forbidden = start({ tool: "wall", mayEdit: { allowed: false, reason: "an observer" } });
    forbidden.drag(at(1, 2));
    expect(forbidden.model.note.value?.text).toContain("an observer");
    const border = start({ tool: "wall" });
    border.drag(at(0, 2));
    expect(border.model.note.value?.text).toContain("row 0, column 2");
    expect([...forbidden.page.asked, ...border.page.asked]).toEqual([]);
  });

  it("cancelled, sends nothing", () => {
    const { page, driver } = start({ tool: "wall" });
    driver.press(at(1, 2), { erase: false });
    driver.cancel();
    driver.release();
    expect(page.asked).toEqual([]);
  });

  it("sends the next stroke when the first has come back", async () => {
    const { page, drag, update } = start({ tool: "wall" });
    drag(at(1, 2));
    drag(at(1, 3));
    await settle();
    expect(page.asked).toHaveLength(1);
    update({ belief: beliefOf(["#######", "#.#...#", ...worldRows.slice(2)], 4n) });
    expect(page.asked[1]).toMatchObject({ base: 4n, cells: [{ cell: at(1, 3), wall: true }] });
  });

  it("keeps what is refused", async () => {
    const { page, model, drag } = start({ tool: "wall" });
    page.outcome = { accepted: false, reason: "revision 3 is old" };
    drag(at(1, 2));
    await settle();
    expect(model.editing.value?.refused?.reason).toBe("revision 3 is old");
  });

  it("keeps a draft while another world is shown, and sends nothing of it there", async () => {
    const { page, model, drag, update } = start({ tool: "wall" });
    page.outcome = { accepted: false, reason: "old" };
    drag(at(1, 2));
    drag(at(1, 3));
    const { world, belief } = page.props;
    update({ world: create(WorldSchema, { ...world, name: "w2" }), belief: undefined });
    await settle();
    expect(page.asked).toHaveLength(1);
    expect(model.editing.value).toBeUndefined();
    update({ world, belief });
    expect(model.editing.value?.refused?.draft.size).toBe(1);
    expect(model.editing.value?.pending?.id).toBe(2);
    await settle();
    expect(page.asked).toHaveLength(2);
  });

  it("keeps what could not be sent at all", async () => {
    const { model, drag } = start({
      tool: "wall",
      onEdit: () => Promise.reject(new Error("no connection")),
    });
    drag(at(1, 2));
    await settle();
    expect(model.editing.value?.refused?.reason).toContain("no connection");
  });
});

describe("the rectangle", () => {
  it("fills between two corners, without the border", () => {
    const { page, drag } = start({ tool: "rectangle" });
    drag(at(3, 3), at(2, 9));
    expect(page.asked).toHaveLength(1);
    expect(page.asked[0]).toMatchObject({
      cells: [at(2, 3), at(2, 5), at(3, 3), at(3, 4), at(3, 5)].map((cell) => ({ cell })),
    });
  });

  it("by keyboard takes a press for each corner", () => {
    const { page, driver } = start({ tool: "rectangle" });
    driver.apply(at(1, 1), { erase: false });
    expect(driver.busy).toBe(true);
    driver.apply(at(1, 2), { erase: false });
    expect(page.asked).toHaveLength(1);
    expect(driver.busy).toBe(false);
  });
});

describe("the path tool", () => {
  it("sends at release what was dragged", () => {
    const { page, drag } = start({ tool: "path" });
    drag(at(1, 1), at(1, 2), at(1, 3));
    expect(page.asked).toEqual([
      { kind: "path", robot: "r1", cells: [at(1, 1), at(1, 2), at(1, 3)] },
    ]);
  });

  it("keeps it as a draft when that is off, until it is sent", () => {
    const { page, model, driver, drag } = start({ tool: "path" });
    model.sendAtRelease.value = false;
    drag(at(1, 1), at(1, 2));
    expect(page.asked).toEqual([]);
    driver.send();
    expect(page.asked).toHaveLength(1);
  });

  it("by keys waits for Send", () => {
    const { page, driver } = start({ tool: "path" });
    driver.apply(at(1, 4), { erase: false });
    driver.apply(at(3, 5), { erase: false });
    expect(page.asked).toEqual([]);
    driver.send();
    expect(page.asked).toMatchObject([{ kind: "path", robot: "r1" }]);
  });

  it("a double click on a corner removes it", () => {
    const { page, model, driver, drag } = start({ tool: "path" });
    driver.apply(at(1, 5), { erase: false });
    driver.apply(at(3, 5), { erase: false });
    drag(at(1, 5));
    drag(at(1, 5));
    driver.doublePress(at(1, 5));
    expect(page.asked).toEqual([]);
    expect(model.paths.value.get("r1")?.cells).not.toContainEqual(at(1, 5));
  });

  it("begins at the robot that is pressed, also where a draft of another one is kept", () => {
    const { page, model, driver } = start({ tool: "path" });
    driver.apply(at(1, 3), { erase: false });
    driver.press(at(3, 5), { erase: false }, "r2");
    driver.drag(at(3, 4));
    driver.release();
    expect(page.asked).toMatchObject([
      { kind: "robot", name: "r2" },
      { kind: "path", robot: "r2" },
    ]);
    expect(model.paths.value.get("r1")?.cells).toHaveLength(3);
  });

  it("draws nothing where the press hits neither a robot nor a path, and says where to start", () => {
    const { page, model, drag } = start({ tool: "path" });
    drag(at(1, 3), at(1, 4), at(1, 5));
    expect(page.asked).toEqual([]);
    expect(model.paths.value.get("r1")?.cells).toEqual([]);
    expect(model.note.value?.text).toContain("Start at a robot");
  });

  it("asks before it sends a path that a robot has seen blocked", () => {
    const cells = new Uint8Array(35);
    cells[1 * 7 + 3] = wallCell;
    const seen = new Map([["r2", create(SeenMapSchema, { robot: "r2", cells })]]);
    const { page, model, driver, drag, update } = start({ tool: "path", seen });
    drag(at(1, 1), at(1, 2), at(1, 3), at(1, 4));
    expect(page.asked).toEqual([]);
    expect(model.paths.value.get("r1")?.asked).toBe(true);
    driver.send();
    expect(page.asked).toHaveLength(1);

    driver.leave();
    driver.apply(at(1, 3), { erase: false });
    driver.send();
    expect([page.asked.length, model.paths.value.get("r1")?.asked]).toEqual([1, true]);
    update({ robots: [robotIn("r1", at(1, 2))] });
    driver.send();
    expect(page.asked).toHaveLength(2);
  });

  it("keeps a path that the robot has left meanwhile, and sends a short join only when asked", () => {
    const { page, driver, update } = start({ tool: "path" });
    const away = (cell: Cell) => {
      driver.press(at(1, 1), { erase: false }, "r1");
      for (const column of [2, 3, 4]) driver.drag(at(1, column));
      update({ robots: [robotIn("r1", cell)] });
      driver.release();
      return page.asked.length;
    };
    expect(away(at(2, 1))).toBe(1); // one step from what was drawn
    update({ robots: [robotIn("r1", at(1, 1))] });
    expect(away(at(3, 1))).toBe(1);
    driver.send();
    expect(page.asked).toHaveLength(2);
    update({ robots: [robotIn("r1", at(1, 1))] });
    expect(away(at(3, 3))).toBe(2);
    driver.send();
    expect(page.asked).toHaveLength(2);
  });

  it("routes go around what robots saw, but not for participants", () => {
    const cells = new Uint8Array(35);
    cells[1 * 7 + 2] = wallCell;
    const seen = new Map([["r2", create(SeenMapSchema, { robot: "r2", cells })]]);
    for (const participates of [false, true]) {
      const { model, driver } = start({ tool: "path", seen, participates });
      driver.apply(at(1, 3), { erase: false });
      expect(model.paths.value.get("r1")?.cells).toHaveLength(participates ? 3 : 7);
    }
  });

  it("goes back to the draft of before when a stroke is cancelled", () => {
    const { model, driver } = start({ tool: "path" });
    driver.apply(at(1, 3), { erase: false });
    const { cells } = model.paths.value.get("r1") ?? {};
    expect(cells).toHaveLength(3);
    driver.press(at(1, 3), { erase: false });
    driver.drag(at(3, 5));
    driver.cancel();
    expect(model.paths.value.get("r1")).toMatchObject({ cells, drawing: false });
  });

  it("goes back to it from where the robot is by then", () => {
    const { model, driver, update } = start({ tool: "path" });
    driver.apply(at(1, 3), { erase: false });
    driver.press(at(1, 3), { erase: false });
    update({ robots: [robotIn("r1", at(1, 2))] });
    driver.cancel();
    expect(model.paths.value.get("r1")?.cells).toEqual([at(1, 2), at(1, 3)]);
  });

  it("chooses the robot that is pressed on, and draws for it at once", () => {
    const { page, driver } = start({ tool: "path", chosenRobot: undefined });
    driver.press(at(3, 5), { erase: false }, "r2");
    driver.drag(at(3, 4));
    driver.release();
    expect(page.asked).toMatchObject([
      { kind: "robot", name: "r2" },
      { kind: "path", robot: "r2", cells: [at(3, 5), at(3, 4)] },
    ]);
  });

  it("by keys asks for a robot if none is chosen", () => {
    const { page, model, driver } = start({ tool: "path", chosenRobot: undefined });
    driver.apply(at(1, 2), { erase: false });
    expect(page.asked).toEqual([]);
    expect(model.note.value).toBeDefined();
  });

  it("goes on at the end of the path that a robot has, and bends it elsewhere", () => {
    const path = [at(1, 1), at(1, 2), at(1, 3)];
    const guidance = new Map([["r1", create(GuidanceSchema, { robot: "r1", revision: 1n, path })]]);
    for (const chosenRobot of ["r1", "r2"]) {
      const { page, drag } = start({ tool: "path", guidance, chosenRobot });
      drag(at(1, 3), at(2, 3), at(3, 3));
      expect(page.asked.at(-1)).toMatchObject({ cells: [...path, at(2, 3), at(3, 3)] });
    }
    const { page, model, driver, drag } = start({ tool: "path", guidance });
    drag(at(1, 2), at(2, 2), at(3, 2));
    expect(page.asked).toEqual([]); // the way there was not drawn
    expect(model.paths.value.get("r1")?.cells).toContainEqual(at(3, 2));
    driver.send();
    expect(page.asked).toHaveLength(1);
  });

  it("clears the path that the robot has; without one only the draft", () => {
    const guidance = create(GuidanceSchema, { revision: 1n, path: [at(1, 1), at(1, 2)] });
    const has = start({ tool: "path", guidance: new Map([["r1", guidance]]) });
    has.driver.clear();
    expect(has.page.asked).toMatchObject([{ kind: "path", cells: [] }]);
    const none = start({ tool: "path" });
    none.driver.apply(at(1, 4), { erase: false });
    none.driver.clear();
    expect(none.page.asked).toEqual([]);
    expect(none.model.paths.value.get("r1")?.cells).toEqual([]);
  });

  it("draws nothing for a robot that may not be guided", () => {
    const { page, model, drag } = start({
      tool: "path",
      mayGuide: { allowed: false, reason: "Bo has control" },
    });
    drag(at(1, 1), at(1, 2));
    expect(page.asked).toEqual([]);
    expect(model.note.value?.text).toContain("Bo has control");
  });

  it("a draft survives that another robot is chosen", () => {
    const { model, driver, update } = start({ tool: "path" });
    driver.apply(at(1, 4), { erase: false });
    update({ chosenRobot: "r2" });
    update({ chosenRobot: "r1" });
    expect(model.paths.value.get("r1")?.cells.at(-1)).toEqual(at(1, 4));
  });
});

describe("a rectangle that the keyboard has begun", () => {
  it("is given up with its tool", () => {
    const { page, model, driver, update } = start({ tool: "rectangle" });
    driver.apply(at(1, 1), { erase: false });
    expect(driver.busy).toBe(true);
    update({ tool: "wall" });
    expect([driver.busy, model.rectangle.value]).toEqual([false, undefined]);
    driver.apply(at(3, 3), { erase: false });
    expect(page.asked).toMatchObject([{ cells: [{ cell: at(3, 3) }] }]);
  });
});
