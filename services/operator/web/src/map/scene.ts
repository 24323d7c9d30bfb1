// Draws one frame of the map: all layers, in their order.

import { CellImage, type CellLook } from "./draw/cell_image";
import type { Draw } from "./draw/context";
import { CachedLayer, Fader } from "./draw/offscreen";
import type { Palette } from "./draw/palette";
import { draftLayers, type EditSession } from "./edit_session";
import {
  beliefLook,
  changesLook,
  differencesLook,
  fogLook,
  heatLook,
  truthLook,
} from "./layers/cell_looks";
import { drawChanges, drawDifferences, drawEdits, drawHeat, drawTruth } from "./layers/cells";
import {
  drawCursor,
  drawFrame,
  drawGridLines,
  drawRulers,
  drawScaleBar,
} from "./layers/grid_lines";
import {
  drawDraftPath,
  drawPathNames,
  drawPaths,
  drawPlans,
  drawTrails,
  laneShift,
  type PathsData,
} from "./layers/paths";
import { drawChosenPicture, PictureMarks } from "./layers/pictures";
import { drawGoalPoses, drawGoals, drawRobots } from "./layers/robots";
import { drawSearches } from "./layers/searches";
import type { Cell, LayerName, MapProps } from "./map_props";
import { wallsCrossed } from "./path/assessment";
import { type PathSession, vertices } from "./path/path_session";
import { showsDetail, type View } from "./view";

export type Rectangle = { readonly from: Cell; readonly to: Cell; readonly wall: boolean };

export type Scene = {
  readonly props: MapProps;
  /** What all robots have seen. */
  readonly seen: Uint8Array;
  readonly view: View;
  readonly palette: Palette;
  readonly editing: EditSession | undefined;
  readonly paths: Iterable<PathSession>;
  readonly ahead: ReadonlyMap<string, readonly Cell[]>; // what is left of each robot's path
  readonly cursor: Cell | undefined; // keyboard's, while it is in use
  readonly hover: Cell | undefined;
  readonly rectangle: Rectangle | undefined;
};

/** Layers that change rarely, kept from frame to frame. */
export class SceneCache {
  readonly belief = new CellImage();
  readonly fog = new CellImage();
  readonly changes = new CellImage();
  readonly differences = new CellImage();
  readonly heat = new CellImage();
  readonly truth = new CellImage();
  readonly ground = new CachedLayer();
  readonly chosen = new CachedLayer();
  readonly goals = new CachedLayer();
  readonly pictures = new PictureMarks();
  readonly fader = new Fader();
}

export function drawScene(context: Draw, scene: Scene, cache: SceneCache): void {
  const { view, palette } = scene;
  cache.ground.draw(context, view, groundKeys(scene), (on) => drawGround(on, scene, cache));
  drawLines(context, scene, cache);
  drawMarks(context, scene, cache);
  drawRulers(
    context,
    view,
    { size: scene.props.world, cell: scene.cursor ?? scene.hover },
    palette,
  );
  drawScaleBar(context, view, scene.props.world, palette);
}

/** All data that drawGround() uses besides the view. */
function groundKeys({ props, seen, palette, editing }: Scene): readonly unknown[] {
  const { world, belief, layers, trails, robots } = props;
  const looks = robots.map(({ robot, colour }) => `${robot.name} ${colour}`).join();
  const cells = [world.rows, world.columns, belief?.walls, belief?.initialWalls, seen];
  return [palette, editing, layers, trails, looks, props.predictions, props.truth, ...cells];
}

function drawGround(context: Draw, scene: Scene, cache: SceneCache): void {
  const { props, view, palette } = scene;
  context.fillStyle = palette.paper;
  context.fillRect(0, 0, view.width, view.height);
  drawCells(context, scene, cache);
  const { robots, trails } = props;
  const show = layerPainter(context, scene, cache);
  show("trails", (on) => drawTrails(on, view, { robots, trails }, palette));
}

/** A function that draws a layer with its opacity. */
function layerPainter(context: Draw, { props, view }: Scene, { fader }: SceneCache) {
  return (name: LayerName, paint: (on: Draw) => void) =>
    fader.draw(context, view, props.layers[name], paint);
}

function drawCells(context: Draw, scene: Scene, cache: SceneCache): void {
  const { props, view, palette, editing } = scene;
  const { world: size, layers } = props;
  const belief = beliefLook(size, wallsOf(props), palette);
  cache.belief.draw(context, view, size, belief, layers.belief);
  const fog = fogLook(scene.seen, palette);
  cache.fog.draw(context, view, size, fog, layers.seen);
  drawGridLines(context, view, size, palette);
  if (showsDetail(view)) drawCellMarks(context, scene, cache);
  else drawCellSpots(context, scene, cache);
  if (editing) drawEdits(context, view, { size, ...draftLayers(editing) }, palette);
}

/** None before the map comes. */
function wallsOf({ world, belief }: MapProps): Uint8Array {
  return belief?.walls ?? new Uint8Array(world.rows * world.columns);
}

/** Signs on cells that are large enough. */
function drawCellMarks(context: Draw, scene: Scene, cache: SceneCache): void {
  const { props, view, palette } = scene;
  const { world: size, belief } = props;
  const show = layerPainter(context, scene, cache);
  const walls = wallsOf(props);
  const { seen } = scene;
  if (belief) {
    const changes = { size, walls, initial: belief.initialWalls };
    show("changes", (on) => drawChanges(on, view, changes, palette));
  }
  show("seen", (on) => drawDifferences(on, view, { size, walls, seen }, palette));
  const predictions = props.predictions.values();
  show("heat", (on) => drawHeat(on, view, { size, predictions }, palette));
  const truth = props.truth?.cells;
  if (truth) show("truth", (on) => drawTruth(on, view, { size, walls, truth }, palette));
}

/** The same as colours of small cells. */
function drawCellSpots(context: Draw, scene: Scene, cache: SceneCache): void {
  const { props, view, palette } = scene;
  const { world: size, belief, layers, truth } = props;
  const walls = wallsOf(props);
  const show = (image: CellImage, layer: LayerName, look: CellLook) =>
    image.draw(context, view, size, look, layers[layer]);
  if (belief) show(cache.changes, "changes", changesLook(walls, belief.initialWalls, palette));
  show(cache.differences, "seen", differencesLook(walls, scene.seen, palette));
  show(cache.heat, "heat", heatLook([...props.predictions.values()], palette));
  if (truth) show(cache.truth, "truth", truthLook(walls, truth.cells, palette));
}

function drawLines(context: Draw, scene: Scene, cache: SceneCache): void {
  const { props, view, palette } = scene;
  const { robots, pictures, plans, searches } = props;
  const show = layerPainter(context, scene, cache);
  show("pictures", (on) => cache.pictures.draw(on, view, { robots, pictures }, palette));
  drawChosen(context, scene, cache);
  show("paths", (on) => drawPaths(on, view, pathsOf(scene), palette));
  show("plan", (on) => drawPlans(on, view, { robots, plans }, palette));
  show("search", (on) => drawSearches(on, view, { robots, searches }, palette));
  for (const path of scene.paths) drawDraft(context, scene, path);
}

function drawChosen(context: Draw, { props, view, palette }: Scene, cache: SceneCache): void {
  const picture = props.chosenPicture;
  if (!picture) return;
  const robot = props.robots.find((one) => one.robot.name === picture.robot);
  const colour = robot?.colour ?? palette.muted;
  const { rows, columns } = props.world;
  cache.chosen.draw(context, view, [palette, picture, colour, rows, columns], (on) =>
    drawChosenPicture(on, view, { size: props.world, picture, colour }, palette),
  );
}

function pathsOf({ props, paths, ahead }: Scene): PathsData {
  const hidden = [...paths].find((path) => path.cells.length > 1)?.robot;
  return { robots: props.robots, paths: ahead, hidden };
}

function drawDraft(context: Draw, { props, view, palette }: Scene, path: PathSession): void {
  const index = props.robots.findIndex((one) => one.robot.name === path.robot);
  const robot = props.robots[index];
  if (!robot || path.cells.length < 2) return;
  const walls = props.belief?.walls;
  const data = {
    robot,
    cells: path.cells,
    undrawn: path.undrawn,
    vertices: vertices(path.cells),
    sent: path.sent?.cells === path.cells,
    trouble: walls ? wallsCrossed(path.cells, { size: props.world, walls }, props.seen) : [],
    shift: laneShift(props.robots, index, view),
  };
  drawDraftPath(context, view, data, palette);
}

/** All data that drawGoals() uses besides the view, as text, because each robot state has new goal objects. */
function goalKeys({ props, palette }: Scene): readonly unknown[] {
  const words = (cells: readonly Cell[]) => cells.map(({ row, column }) => `${row},${column}`);
  const goals = props.robots.map(({ robot, colour, letter }) =>
    [robot.name, colour, letter, ...words(robot.goalsLeft), "/", ...words(robot.goalsReached)].join(
      " ",
    ),
  );
  return [palette, goals.join()];
}

function drawMarks(context: Draw, scene: Scene, cache: SceneCache): void {
  const { props, view, palette } = scene;
  const { robots, goalPoses, world } = props;
  const show = layerPainter(context, scene, cache);
  show("goals", (on) =>
    cache.goals.draw(on, view, goalKeys(scene), (cached) =>
      drawGoals(cached, view, robots, palette),
    ),
  );
  show("goalPoses", (on) => drawGoalPoses(on, view, { robots, goalPoses }, palette));
  show("paths", (on) => drawPathNames(on, view, pathsOf(scene), palette));
  drawRobots(context, view, { world, robots, chosen: props.chosenRobot }, palette);
  const { hover, rectangle, cursor } = scene;
  if (rectangle) drawFrame(context, view, rectangle, palette);
  else if (hover && props.tool !== "look") {
    drawFrame(context, view, { from: hover, to: hover }, palette);
  }
  if (cursor) drawCursor(context, view, cursor, palette);
}
