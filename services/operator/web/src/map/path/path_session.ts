// The path that is being drawn for one robot, as a pure state machine. A draft is 4-connected, begins in the robot's cell and
// stays in the grid, or is empty. It is kept until the service has accepted it and sent it back as newer guidance.
import { type Cell, cellIndex, clampCell, sameCell } from "../grid";
import type { Outcome } from "../map_props";
import { freehandRoute, type RouteGrid, route, shortestRoute } from "./routes";

type SentPath = {
  readonly id: number;
  readonly cells: readonly Cell[]; // empty = withdraw
  readonly after: bigint; // revision of the robot's guidance when it was sent; 0 = none
  readonly accepted: boolean;
};

/** The parts of a path that stay while a cell between them is dragged. */
type Bend = { readonly before: readonly Cell[]; readonly after: readonly Cell[] };

export type PathSession = {
  readonly robot: string;
  readonly start: Cell; // where the robot is
  readonly cells: readonly Cell[];
  readonly drawing: boolean;
  readonly bend: Bend | undefined;
  readonly sent: SentPath | undefined;
  readonly refusal: string | undefined;
  readonly revision: bigint; // of the robot's guidance as the service shows it; 0 = none
  readonly lastId: number;
};

export function newPathSession(robot: string, start: Cell): PathSession {
  return {
    robot,
    start,
    cells: [],
    drawing: false,
    bend: undefined,
    sent: undefined,
    refusal: undefined,
    revision: 0n,
    lastId: 0,
  };
}

/** Starts at the robot or continues the draft. A press on the robot starts over. */
export function beginDrawing(session: PathSession, grid: RouteGrid, cell: Cell): PathSession {
  const goOn = session.cells.length > 1 && !sameCell(cell, session.start);
  const cells = goOn ? session.cells : [session.start];
  return extend({ ...session, cells, drawing: true, refusal: undefined }, grid, cell, route);
}

/** Moving back over the last step removes it. */
export function drawTo(session: PathSession, grid: RouteGrid, cell: Cell): PathSession {
  if (!session.drawing) return session;
  if (session.cells.length > 1 && sameCell(cell, session.cells.at(-2))) {
    return { ...session, cells: session.cells.slice(0, -1) };
  }
  return extend(session, grid, cell, freehandRoute);
}

export function endDrawing(session: PathSession): PathSession {
  return { ...session, cells: worthKeeping(session.cells), drawing: false };
}

function extend(
  session: PathSession,
  grid: RouteGrid,
  cell: Cell,
  find: (grid: RouteGrid, from: Cell, to: Cell) => Cell[],
): PathSession {
  const last = session.cells.at(-1) ?? session.start;
  return {
    ...session,
    cells: joined(session.cells, find(grid, last, clampCell(grid.size, cell))),
  };
}

function worthKeeping(cells: readonly Cell[]): readonly Cell[] {
  return cells.length > 1 ? cells : [];
}

function joined(...parts: (readonly Cell[])[]): Cell[] {
  return parts.flat().filter((cell, index, all) => !sameCell(cell, all[index - 1]));
}

/** Indices of the ends and corners, where a path can be dragged; ascending. */
export function vertices(cells: readonly Cell[]): number[] {
  return cells.flatMap((cell, index) => {
    const before = cells[index - 1];
    const after = cells[index + 1];
    const straight =
      before &&
      after &&
      cell.row - before.row === after.row - cell.row &&
      cell.column - before.column === after.column - cell.column;
    return straight ? [] : [index];
  });
}

/** Index of the path's cell to grab at `cell`; never the robot's own cell. */
function handle(cells: readonly Cell[], cell: Cell): number | undefined {
  const index = cells.map((other) => sameCell(other, cell)).lastIndexOf(true);
  return index > 0 ? index : undefined;
}

export function canGrab(session: PathSession, cell: Cell): boolean {
  return handle(session.cells, cell) !== undefined;
}

/** Grabs the path at a vertex, or between vertices, which makes a new one. */
export function grab(session: PathSession, cell: Cell): PathSession {
  const index = handle(session.cells, cell);
  if (index === undefined) return session;
  const corners = vertices(session.cells);
  const from = corners.filter((corner) => corner < index).at(-1) ?? 0;
  const to = corners.find((corner) => corner > index);
  const bend = {
    before: session.cells.slice(0, from + 1),
    after: to === undefined ? [] : session.cells.slice(to),
  };
  return { ...session, bend, refusal: undefined };
}

export function bendTo(session: PathSession, grid: RouteGrid, target: Cell): PathSession {
  if (!session.bend) return session;
  const { before, after } = session.bend;
  const cell = clampCell(grid.size, target);
  const onward = after[0] ? route(grid, cell, after[0]) : [];
  const toThere = route(grid, before.at(-1) ?? session.start, cell);
  return { ...session, cells: joined(before, toThere, onward, after) };
}

export function endBend(session: PathSession): PathSession {
  return { ...session, cells: worthKeeping(session.cells), bend: undefined };
}

/** Removes a vertex. At the end: shortens the path to the vertex before. Between: connects its neighbours by a shortest route. */
export function removeVertex(session: PathSession, grid: RouteGrid, cell?: Cell): PathSession {
  const index = cell ? handle(session.cells, cell) : session.cells.length - 1;
  if (index === undefined || index < 1) return session;
  const { bend, ...grabbed } = grab(session, session.cells[index] ?? session.start);
  if (!bend) return session;
  const from = bend.before.at(-1);
  const onward = bend.after[0];
  const between = onward && from ? routeWithout(grid, from, onward, session.cells[index]) : [];
  const cells = worthKeeping(joined(bend.before, between, bend.after));
  return { ...grabbed, bend: undefined, cells };
}

/** Avoids `without` if another route is as short. */
function routeWithout(grid: RouteGrid, from: Cell, to: Cell, without: Cell | undefined): Cell[] {
  const shortest = route(grid, from, to);
  if (!without) return shortest;
  const walls = grid.walls.slice();
  walls[cellIndex(grid.size, without)] = 255;
  const other = shortestRoute({ ...grid, walls }, from, to);
  return other && other.length <= shortest.length ? other : shortest;
}

/** Makes the robot's current path the draft. */
export function adopt(session: PathSession, grid: RouteGrid, path: readonly Cell[]): PathSession {
  return { ...session, cells: worthKeeping(startingAt(session.start, grid, path)) };
}

export function robotMoved(session: PathSession, grid: RouteGrid, cell: Cell): PathSession {
  if (sameCell(cell, session.start)) return session;
  const moved = (cells: readonly Cell[]) => startingAt(cell, grid, cells);
  const bend = session.bend && { ...session.bend, before: moved(session.bend.before) };
  const active = session.drawing || session.bend !== undefined;
  const rest = moved(session.cells);
  const cells = active ? rest : worthKeeping(rest);
  const { sent } = session;
  const follows = sent && sent.cells === session.cells ? { ...sent, cells } : sent;
  return { ...session, start: cell, bend, cells, sent: follows };
}

/** The rest of the path for a robot in `start`, with a route to the path if the robot is not on it. */
function startingAt(start: Cell, grid: RouteGrid, path: readonly Cell[]): readonly Cell[] {
  const index = path.findIndex((cell) => sameCell(cell, start));
  if (index >= 0) return path.slice(index);
  return path[0] ? joined(route(grid, start, path[0]), path) : path;
}

/** Restores the draft of `before`, adapted to the robot's current cell. */
export function revert(session: PathSession, before: PathSession, grid: RouteGrid): PathSession {
  const { cells, refusal } = before;
  const stands = sameCell(session.start, before.start);
  const kept = stands ? cells : worthKeeping(startingAt(session.start, grid, cells));
  return { ...leave(session), cells: kept, refusal };
}

export function leave(session: PathSession): PathSession {
  return { ...session, cells: [], drawing: false, bend: undefined, refusal: undefined };
}

export function hasDraft(session: PathSession): boolean {
  return session.cells.length > 1;
}

/** Sends the draft; nothing happens without one. */
export function send(session: PathSession): PathSession {
  return hasDraft(session) ? sending(session, session.cells) : session;
}

/** Withdraws the robot's path and drops the draft. */
export function withdraw(session: PathSession): PathSession {
  return sending(leave(session), []);
}

function sending(session: PathSession, cells: readonly Cell[]): PathSession {
  const id = session.lastId + 1;
  const sent = { id, cells, after: session.revision, accepted: false };
  return { ...session, drawing: false, bend: undefined, refusal: undefined, lastId: id, sent };
}

/** The service's reply. Replies to replaced paths are ignored. A refused draft stays. */
export function replied(session: PathSession, id: number, outcome: Outcome): PathSession {
  if (session.sent?.id !== id) return session;
  if (outcome.accepted) return settled({ ...session, sent: { ...session.sent, accepted: true } });
  const cells = session.cells.length > 0 ? session.cells : session.sent.cells;
  const refusal = outcome.reason || "the service refused the path";
  return { ...session, cells, sent: undefined, refusal };
}

/** Revision of the guidance that the service shows; 0 = none. */
export function guidanceCame(session: PathSession, revision: bigint): PathSession {
  if (revision === session.revision) return session;
  return settled({ ...session, revision });
}

/** Drops the draft once it is the robot's path. A newer draft stays. */
function settled(session: PathSession): PathSession {
  const { sent } = session;
  if (!sent?.accepted || session.revision === sent.after) return session;
  const done = sent.cells === session.cells;
  return { ...session, sent: undefined, cells: done ? [] : session.cells };
}
