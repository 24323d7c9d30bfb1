// The path that is being drawn for one robot, as a pure state machine. A draft is 4-connected, begins in the robot's cell and
// stays in the grid, or is empty. It is kept until the service has accepted it and sent it back as newer guidance. What the hand
// draws is sent; where the robot left it meanwhile, a join of `longestJoin` steps is sent after a second look, and no longer one.
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
  /** Number of cells before the first one that was drawn: where the robot went, and the join from there. */
  readonly undrawn: number;
  /** Whether parts of it are routes, not what the hand drew. */
  readonly routed: boolean;
  /** Whether the draft waits for a second yes, because it is known to be blocked. */
  readonly asked: boolean;
  readonly drawing: boolean;
  /** Number of cells at the end that the hand has drawn since it pressed. */
  readonly fresh: number;
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
    undrawn: 0,
    routed: false,
    asked: false,
    drawing: false,
    fresh: 0,
    bend: undefined,
    sent: undefined,
    refusal: undefined,
    revision: 0n,
    lastId: 0,
  };
}

/** Steps of a join that may still be sent. */
export const longestJoin = 3;

/** Begins a path at the robot. A draft is dropped. */
export function beginDrawing(session: PathSession): PathSession {
  return { ...changed(session, [session.start], 0), drawing: true, fresh: 0 };
}

/** Goes on at the end of the draft. */
export function continueDrawing(session: PathSession): PathSession {
  return hasDraft(session)
    ? { ...session, asked: false, drawing: true, fresh: 0, refusal: undefined }
    : session;
}

/** Adds the shortest route from the end of the draft, or from the robot, to a cell. For the keyboard, which draws no lines. */
export function addRoute(session: PathSession, grid: RouteGrid, cell: Cell): PathSession {
  const begun = hasDraft(session) ? session : changed(session, [session.start], 0);
  const { cells, undrawn } = extend(begun, grid, cell, route);
  return { ...changed(session, worthKeeping(cells), undrawn), routed: true };
}

/** Another draft. */
function changed(session: PathSession, cells: readonly Cell[], undrawn: number): PathSession {
  return { ...session, cells, undrawn, routed: false, asked: false, refusal: undefined };
}

/** Moving back over the last step that this press drew removes it; over earlier ones, the path leads back. */
export function drawTo(session: PathSession, grid: RouteGrid, cell: Cell): PathSession {
  if (!session.drawing) return session;
  if (session.fresh > 0 && sameCell(cell, session.cells.at(-2))) {
    const cells = session.cells.slice(0, -1);
    return {
      ...session,
      cells,
      fresh: session.fresh - 1,
      undrawn: leadOf(cells, session.undrawn),
    };
  }
  const longer = extend(session, grid, cell, freehandRoute);
  return { ...longer, fresh: session.fresh + longer.cells.length - session.cells.length };
}

export function endDrawing(session: PathSession): PathSession {
  return { ...session, cells: worthKeeping(session.cells), drawing: false };
}

/** Where the draft, or without one the robot's path `given`, ends. */
export function endOf(session: PathSession, given: readonly Cell[]): Cell | undefined {
  return hasDraft(session) ? session.cells.at(-1) : given.at(-1);
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
  return { ...session, bend, asked: false, refusal: undefined };
}

export function bendTo(session: PathSession, grid: RouteGrid, target: Cell): PathSession {
  if (!session.bend) return session;
  const { before, after } = session.bend;
  const cell = clampCell(grid.size, target);
  const onward = after[0] ? route(grid, cell, after[0]) : [];
  const toThere = route(grid, before.at(-1) ?? session.start, cell);
  return { ...session, ...withLead(joined(before, toThere, onward, after), session.undrawn) };
}

export function endBend(session: PathSession): PathSession {
  return { ...session, ...withLead(worthKeeping(session.cells), session.undrawn), bend: undefined };
}

function withLead(cells: readonly Cell[], undrawn: number) {
  return { cells, undrawn: leadOf(cells, undrawn), routed: true };
}

/** The last cell is where the hand is. */
function leadOf(cells: readonly Cell[], undrawn: number): number {
  return Math.min(undrawn, Math.max(0, cells.length - 1));
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
  return { ...grabbed, bend: undefined, ...withLead(cells, session.undrawn) };
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
  const { cells, undrawn } = startingAt(session.start, grid, path);
  return changed(session, worthKeeping(cells), undrawn);
}

export function robotMoved(session: PathSession, grid: RouteGrid, cell: Cell): PathSession {
  if (sameCell(cell, session.start)) return session;
  const moved = (cells: readonly Cell[]) => startingAt(cell, grid, cells.slice(session.undrawn));
  const bend = session.bend && { ...session.bend, before: moved(session.bend.before).cells };
  const active = session.drawing || session.bend !== undefined;
  const { cells: rest, undrawn } = moved(session.cells);
  const cells = active ? rest : worthKeeping(rest);
  const { sent } = session;
  const follows = sent && sent.cells === session.cells ? { ...sent, cells } : sent;
  return { ...session, start: cell, bend, cells, undrawn, sent: follows };
}

/** What is left of the drawn path for a robot in `start`, with a route to it if the robot is not on it. */
function startingAt(
  start: Cell,
  grid: RouteGrid,
  path: readonly Cell[],
): Pick<PathSession, "cells" | "undrawn"> {
  const index = path.findIndex((cell) => sameCell(cell, start));
  if (index >= 0) return { cells: path.slice(index), undrawn: 0 };
  if (!path[0]) return { cells: path, undrawn: 0 };
  const join = route(grid, start, path[0]);
  return { cells: joined(join, path), undrawn: join.length - 1 };
}

/** Whether it may be sent at release: only the robot's step onto it was not drawn. */
export function isDrawnByHand({ routed, undrawn }: PathSession): boolean {
  return !routed && undrawn <= 1;
}

/** Restores the draft of `before`, adapted to the robot's current cell. */
export function revert(session: PathSession, before: PathSession, grid: RouteGrid): PathSession {
  const stands = sameCell(session.start, before.start);
  const kept = stands ? before : robotMoved(before, grid, session.start);
  return {
    ...leave(session),
    cells: worthKeeping(kept.cells),
    undrawn: kept.undrawn,
    refusal: before.refusal,
  };
}

export function leave(session: PathSession): PathSession {
  return { ...changed(session, [], 0), drawing: false, bend: undefined };
}

export function hasDraft(session: PathSession): boolean {
  return session.cells.length > 1;
}

/** Whether the robot has gone so far from the draft that it cannot be sent. */
export function isLeft(session: PathSession): boolean {
  return session.undrawn > longestJoin;
}

/** Waits for a second yes. */
export function ask(session: PathSession): PathSession {
  return { ...session, asked: true };
}

/** Sends the draft; nothing happens without one, or to one that the robot has left. */
export function send(session: PathSession): PathSession {
  return hasDraft(session) && !isLeft(session) ? sending(session, session.cells) : session;
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
