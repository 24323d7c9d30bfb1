import { create } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { setWords } from "../../app/words";
import {
  PredictionSchema,
  RobotSchema,
  SearchSchema,
  SnapshotSchema,
  WorldSchema,
} from "../../protocol/generated/console_pb";
import { namedPalette, RecordingContext } from "../draw/recording";
import type { MapRobot } from "../map_props";
import type { View } from "../view";
import { drawChanges, drawDifferences, drawEdits, drawHeat, drawTruth } from "./cells";
import { drawGridLines, drawRulers, drawScaleBar, rulerStep, scaleBar } from "./grid_lines";
import { drawDraftPath, drawPathNames, drawPaths } from "./paths";
import { drawChosenPicture, drawPictures } from "./pictures";
import { drawGoals, drawRobots } from "./robots";
import { drawSearches } from "./searches";

const size = { rows: 3, columns: 4 };
const near: View = { scale: 40, x: 100, y: 50, width: 800, height: 600 };
const far: View = { ...near, scale: 4 };
const at = (row: number, column: number) => ({ row, column });

function bytes(values: Record<number, number>): Uint8Array {
  const all = new Uint8Array(size.rows * size.columns);
  for (const [index, value] of Object.entries(values)) all[Number(index)] = value;
  return all;
}

function robot(name: string, more: Partial<MapRobot> = {}): MapRobot {
  const robot = create(RobotSchema, {
    name,
    cell: at(1, 1),
    goalsLeft: [at(1, 2)],
    goalsReached: [at(0, 1)],
  });
  const look = { colour: `colour of ${name}`, shape: "circle", dash: [8, 4], letter: "A" } as const;
  return { robot, ...look, fresh: "live", stopped: false, ...more };
}

function recorded(draw: (context: RecordingContext) => void): RecordingContext {
  const context = new RecordingContext();
  draw(context);
  return context;
}

describe("level of detail", () => {
  it("has grid lines between large cells, none between small ones", () => {
    expect(recorded((on) => drawGridLines(on, near, size, namedPalette)).calls).not.toEqual([]);
    expect(recorded((on) => drawGridLines(on, far, size, namedPalette)).calls).toEqual([]);
  });

  it("numbers every row and column when there is room, fewer when not", () => {
    const data = { size, cell: undefined };
    const context = recorded((on) => drawRulers(on, near, data, namedPalette));
    expect(context.texts()).toEqual(["0", "1", "2", "3", "0", "1", "2"]);
    expect([rulerStep(40), rulerStep(5), rulerStep(2)]).toEqual([1, 5, 20]);
  });

  it("always numbers the cursor's row and column", () => {
    const context = recorded((on) => drawRulers(on, far, { size, cell: at(1, 3) }, namedPalette));
    expect(context.texts()).toEqual(expect.arrayContaining(["3", "1"]));
  });

  it("says how long a metre is where rows are too small for a number each, at every zoom", () => {
    const texts = (world: { rows: number; columns: number; cellSize: number }, view: View) =>
      recorded((on) => drawScaleBar(on, view, world, namedPalette)).texts();
    const building = { rows: 1000, columns: 600, cellSize: 0.1 };
    expect([0.5, 8, 40].map((scale) => texts(building, { ...near, scale })[0])).toEqual([
      "20 m",
      "1 m",
      "20 cm",
    ]);
    expect(texts({ rows: 13, columns: 13, cellSize: 2 }, near)).toEqual([]);
    expect(scaleBar(2, 5, 120)).toEqual({ m: 200, px: 80 });
  });

  it("leaves names out where cells are small", () => {
    const world = create(WorldSchema, { ...size, cellSize: 2 });
    const data = { world, robots: [robot("r1")], chosen: undefined };
    expect(recorded((on) => drawRobots(on, near, data, namedPalette)).texts()).toEqual(["A", "r1"]);
    expect(recorded((on) => drawRobots(on, far, data, namedPalette)).texts()).toEqual(["A"]);
  });
});

describe("what the operator changed", () => {
  it("has a plus (two lines) where a wall was added, a minus where one was taken", () => {
    const changed = (walls: Uint8Array, initial: Uint8Array) =>
      recorded((on) => drawChanges(on, near, { size, walls, initial }, namedPalette));
    const wall = bytes({ 6: 255 });
    expect(changed(wall, bytes({})).named("lineTo")).toHaveLength(2);
    expect(changed(bytes({}), wall).named("lineTo")).toHaveLength(1);
    expect(changed(wall, wall).named("fillRect")).toEqual([]);
  });
});

describe("what the robots saw", () => {
  const seen = bytes({ 5: 1, 6: 2, 9: 2 });

  it("is marked only where the operator's map says otherwise: a frame = wall, a ring = free", () => {
    const drawn = (walls: Uint8Array) =>
      recorded((on) => drawDifferences(on, near, { size, walls, seen }, namedPalette));
    expect(drawn(bytes({ 6: 255, 9: 255 })).named("stroke")).toEqual([]);
    expect(
      drawn(bytes({ 9: 255 }))
        .named("rect")[0]
        ?.values.slice(0, 2),
    ).toEqual([185.6, 95.6]);
    expect(drawn(bytes({ 5: 255, 6: 255, 9: 255 })).named("arc")).toHaveLength(1);
  });
});

describe("expected edits", () => {
  it("are filled in the colour of adding or taking away, with hatches that lean apart", () => {
    const heat = (add: Uint8Array, remove: Uint8Array) => {
      const predictions = [create(PredictionSchema, { add, remove })];
      return recorded((on) => drawHeat(on, near, { size, predictions }, namedPalette));
    };
    const add = heat(bytes({ 5: 200 }), bytes({}));
    const remove = heat(bytes({}), bytes({ 5: 200 }));
    expect(add.named("fillRect").map(({ fill }) => fill)).toEqual(["add"]);
    expect(remove.named("fillRect").map(({ fill }) => fill)).toEqual(["remove"]);
    const slope = (context: RecordingContext) => {
      const [, y1] = context.named("moveTo")[0]?.values ?? [];
      const [, y2] = context.named("lineTo")[0]?.values ?? [];
      return Math.sign(Number(y2) - Number(y1));
    };
    expect(slope(add)).toBe(-slope(remove));
    expect(heat(bytes({ 5: 3 }), bytes({})).named("fillRect")).toEqual([]);
  });
});

describe("the truth", () => {
  it("frames walls and crosses out the map's mistakes", () => {
    const truth = bytes({ 5: 2, 6: 1 });
    const context = recorded((on) =>
      drawTruth(on, near, { size, walls: bytes({ 6: 255 }), truth }, namedPalette),
    );
    expect(context.named("strokeRect")).toHaveLength(1);
    expect(context.named("stroke")).toHaveLength(2);
  });
});

describe("paths", () => {
  const path = [at(1, 1), at(1, 2), at(2, 2)];
  const paths = new Map([["r1", path]]);
  const data = { robots: [robot("r1"), robot("r2")], paths, hidden: undefined };

  it("are in the robot's colour and dash, an arrow head at the end", () => {
    const context = recorded((on) => drawPaths(on, near, data, namedPalette));
    expect(context.named("stroke").map(({ stroke }) => stroke)).toContain("colour of r1");
    expect(context.named("setLineDash").map(({ values }) => values[0])).toContainEqual([8, 4]);
    expect(context.named("fill").at(-1)?.fill).toBe("colour of r1");
  });

  it("bear the robot's name", () => {
    expect(recorded((on) => drawPathNames(on, near, data, namedPalette)).texts()).toEqual(["r1"]);
  });

  it("in the making mark the walls that they cross and have handles until they are sent", () => {
    const draft = { robot: robot("r1"), cells: path, undrawn: 0, vertices: [0, 1, 2], shift: 0 };
    const handles = (sent: boolean) =>
      recorded((on) =>
        drawDraftPath(on, near, { ...draft, sent, trouble: [at(1, 2)] }, namedPalette),
      );
    expect(handles(false).named("arc")).toHaveLength(2);
    expect(handles(true).named("arc")).toHaveLength(0);
    expect(handles(false).named("stroke").at(-1)?.stroke).toBe("refused");
  });
});

describe("pictures", () => {
  const picture = create(SnapshotSchema, {
    robot: "r1",
    cell: at(1, 1),
    heading: Math.PI / 2,
    fieldOfView: 1,
    freeCells: { row: [0], column: [1] },
    wallCells: { row: [0], column: [2] },
  });

  it("have a cone in the direction of view: north is up on the canvas", () => {
    const data = { robots: [robot("r1")], pictures: [picture] };
    const [cone] = recorded((on) => drawPictures(on, near, data, namedPalette)).named("arc");
    expect(cone?.values.slice(0, 2)).toEqual([160, 110]);
    const [, , , from, to] = cone?.values ?? [];
    expect((Number(from) + Number(to)) / 2).toBeCloseTo(-Math.PI / 2);
  });

  it("that are chosen show a dot per free cell and a frame per wall", () => {
    const data = { size, picture, colour: "c" };
    const context = recorded((on) => drawChosenPicture(on, near, data, namedPalette));
    expect(context.named("arc")[1]?.values.slice(0, 2)).toEqual([160, 70]);
    expect(context.named("rect")[1]?.values.slice(0, 2)).toEqual([183, 53]);
  });
});

it("a search's arrows are the wider the more visits, and say the share of what was chosen", () => {
  const search = create(SearchSchema, {
    cell: at(1, 1),
    chosen: 0,
    actions: [
      { target: at(1, 2), visits: 30 },
      { target: at(2, 1), visits: 10 },
    ],
  });
  const widths: number[] = [];
  const context = new RecordingContext();
  const stroke = context.stroke;
  context.stroke = () => {
    widths.push(context.lineWidth);
    stroke();
  };
  const data = { robots: [robot("r1")], searches: new Map([["r1", search]]) };
  drawSearches(context, near, data, namedPalette);
  expect(widths[0]).toBeGreaterThan(widths[1] ?? 0);
  expect(context.texts()).toEqual(["75 %"]);
});

it("goals have the robot's letter, reached ones a tick instead", () => {
  const context = recorded((on) => drawGoals(on, near, [robot("r1")], namedPalette));
  expect(context.texts()).toEqual(["A"]);
  expect(context.named("fill").map(({ fill }) => fill)).toEqual(["free", "colour of r1"]);
});

it("a robot that is stopped says so", () => {
  const world = create(WorldSchema, { ...size, cellSize: 2 });
  const data = { world, robots: [robot("r1", { stopped: true })], chosen: undefined };
  const texts = () => recorded((on) => drawRobots(on, near, data, namedPalette)).texts();
  expect(texts()).toContain("r1 (stopped)");
  setWords({ stopped: "angehalten" });
  expect(texts()).toContain("r1 (angehalten)");
  setWords({});
});

it("robots that are not live look it without colour: dashed, and with a question mark when lost", () => {
  const world = create(WorldSchema, { ...size, cellSize: 2 });
  const drawn = (fresh: MapRobot["fresh"]) =>
    recorded((on) =>
      drawRobots(on, near, { world, robots: [robot("r1", { fresh })], chosen: "r1" }, namedPalette),
    );
  const dashes = (context: RecordingContext) =>
    context.named("setLineDash").some(({ values }) => String(values[0]) !== "");
  expect(dashes(drawn("live"))).toBe(false);
  expect(dashes(drawn("stale"))).toBe(true);
  expect(drawn("lost").texts()).toEqual(["?", "A", "r1 (lost)"]);
});

it("unconfirmed edits: refused ones in their colour, pending ones dashed, a wall hatched", () => {
  const context = recorded((on) =>
    drawEdits(
      on,
      near,
      {
        size,
        refused: new Map([[5, true]]),
        pending: [new Map([[6, false]])],
        stroke: new Map(),
      },
      namedPalette,
    ),
  );
  expect(context.named("stroke").map(({ stroke }) => stroke)).toEqual(["refused", "draft"]);
  expect(context.named("fillRect").map(({ fill }) => fill)).toEqual(["wall", "free"]);
  expect(context.named("setLineDash").map(({ values }) => values[0])).toContainEqual([3, 3]);
});
