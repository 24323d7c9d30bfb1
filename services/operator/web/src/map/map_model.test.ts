import { create } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { GuidanceSchema, SeenMapSchema } from "../protocol/generated/console_pb";
import { canUndo, endStroke, paint, undo } from "./edit_session";
import { at, beliefOf, FakePage, robotIn, worldRows } from "./fixtures";
import { freeCell, wallCell } from "./grid";
import { MapModel } from "./map_model";

const focusOn = (counter: number) => new FakePage({ focus: { cell: at(3, 5), counter } }).props;

describe("centring on a cell", () => {
  it("moves nothing while all of the map is in sight", () => {
    const model = new MapModel(new FakePage().props);
    model.resize(400, 300);
    const before = model.view.value;
    model.update(focusOn(1));
    expect(model.view.value).toEqual(before);
  });

  it("brings the cell to the middle of a map that was zoomed into, once", () => {
    const model = new MapModel(new FakePage().props);
    model.resize(400, 300);
    model.zoom(3);
    model.update(focusOn(1));
    const { x, scale } = model.view.value ?? { x: 0, scale: 0 };
    expect(x + 5.5 * scale).toBeCloseTo(24 + (400 - 24) / 2);
    model.zoom(1.1);
    const zoomed = model.view.value;
    model.update(focusOn(1));
    expect(model.view.value).toEqual(zoomed);
  });
});

it("keeps undo and drafts of paths while the past is shown", async () => {
  const { props } = new FakePage();
  const model = new MapModel(props);
  const edited = { ...props, belief: beliefOf(["#######", "##....#", ...worldRows.slice(2)], 4n) };
  model.change((session) => endStroke(paint(session, [at(1, 1)], true)));
  await Promise.resolve();
  model.update(edited);
  const mayUndo = () => model.editing.value && canUndo(model.editing.value);
  expect(mayUndo()).toBe(true);
  const paths = model.paths.value;
  model.update({ ...props, isPast: true, robots: [robotIn("r1", at(3, 3))] });
  expect(mayUndo()).toBeUndefined();
  model.update(edited);
  expect(mayUndo()).toBe(true);
  expect(model.paths.value).toBe(paths);
});

describe("zooming out", () => {
  it("ends where all of the map is in sight", () => {
    const model = new MapModel(new FakePage().props);
    model.resize(400, 300);
    const all = model.view.value;
    for (const factor of [0.5, 3, 0.01]) model.zoom(factor, { x: 10, y: 200 });
    expect(model.view.value).toEqual(all);
    model.zoom(2);
    expect(model.view.value?.scale).toBeCloseTo(2 * (all?.scale ?? 0));
  });
});

describe("a path", () => {
  const path = [at(1, 1), at(1, 2), at(1, 3), at(1, 2), at(1, 1), at(2, 1)];
  const given = create(GuidanceSchema, { robot: "r1", revision: 1n, path });

  it("is used up as its robot drives it, also where it comes back", () => {
    const page = new FakePage({ guidance: new Map([["r1", given]]) });
    const model = new MapModel(page.props);
    const left = (...cells: [number, number][]) => {
      for (const [row, column] of cells) {
        model.update({ ...page.props, robots: [robotIn("r1", at(row, column))] });
      }
      return model.ahead.value.get("r1")?.length;
    };
    expect(left([1, 1])).toBe(6);
    expect(left([1, 2], [1, 3])).toBe(4);
    expect(left([1, 2])).toBe(3);
    expect(left([3, 5])).toBe(3); // off the path
    const repeated = (row: number, column: number) => {
      const again = create(GuidanceSchema, { robot: "r1", revision: 2n, path });
      const robots = [robotIn("r1", at(row, column))];
      model.update({ ...page.props, guidance: new Map([["r1", again]]), robots });
      return model.ahead.value.get("r1")?.length;
    };
    expect(repeated(3, 5)).toBe(3); // by an answer
    expect(repeated(1, 1)).toBe(6); // where it begins
  });

  it("that is seen for the first time is used up by the robot's trail", () => {
    const page = new FakePage({ guidance: new Map([["r1", given]]) });
    const trail = [at(1, 2), at(1, 1), at(1, 2), at(1, 3), at(2, 3)];
    const trails = new Map([["r1", trail]]);
    const model = new MapModel({ ...page.props, trails, robots: [robotIn("r1", at(2, 3))] });
    expect(model.ahead.value.get("r1")).toMatchObject(path.slice(2));
  });
});

describe("what robots saw", () => {
  const cells = new Uint8Array(35);
  cells[1 * 7 + 3] = wallCell; // free on the map
  cells[2 * 7 + 2] = freeCell; // a wall on the map
  cells[1 * 7 + 1] = freeCell; // agrees
  cells[0] = freeCell; // the border is fixed
  const seen = new Map([["r1", create(SeenMapSchema, { robot: "r1", cells })]]);

  it("is accepted as one edit, which undo takes back", () => {
    const page = new FakePage({ seen });
    const model = new MapModel(page.props);
    expect(model.differences()).toHaveLength(2);
    model.accept(model.differences());
    expect(page.asked).toMatchObject([
      {
        kind: "edit",
        cells: [
          { cell: at(1, 3), wall: true },
          { cell: at(2, 2), wall: false },
        ],
      },
    ]);
    model.change(undo);
    expect(model.editing.value?.queue).toHaveLength(1);
  });

  it("is accepted from elsewhere on the page once, where editing is allowed", () => {
    const change = { changes: [{ cell: at(1, 3), wall: true }], counter: 1 };
    const page = new FakePage();
    const model = new MapModel(page.props);
    model.update({ ...page.props, accept: change });
    model.update({ ...page.props, accept: change, chosenRobot: "r2" });
    expect(page.asked).toHaveLength(1);
    const mayEdit = { allowed: false, reason: "an observer" } as const;
    model.update({ ...page.props, mayEdit, accept: { ...change, counter: 2 } });
    expect(page.asked).toHaveLength(1);
    expect(model.note.value?.text).toContain("an observer");
  });
});
