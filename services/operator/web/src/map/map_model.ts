// The map's own state beyond its props: view, cursor, drafts of edits and paths. Sends the requests.
import { computed, type ReadonlySignal, type Signal, signal } from "@preact/signals";
import type { Guidance } from "../protocol/generated/console_pb";
import * as edits from "./edit_session";
import type { GoalChange } from "./goals";
import { type Cell, contains, sameCell } from "./grid";
import type { CellChange, MapProps, Outcome } from "./map_props";
import { type Assessment, assess } from "./path/assessment";
import * as paths from "./path/path_session";
import type { RouteGrid } from "./path/routes";
import type { Rectangle } from "./scene";
import { differencesOf, keptFor, SeenTogether, wallsKnown } from "./seen_together";
import {
  centreOn,
  fitView,
  keepInSight,
  type Point,
  resized,
  reveal,
  type View,
  zoomAbout,
} from "./view";

export type Note = { readonly text: string; readonly number: number };

export class MapModel {
  readonly props: Signal<MapProps>;
  /** The same for the bars around the map: they need not follow every move of a robot. */
  readonly calm: ReadonlySignal<MapProps>;
  readonly view = signal<View | undefined>(undefined);
  readonly hover = signal<Cell | undefined>(undefined);
  readonly cursor = signal<Cell | undefined>(undefined);
  /** Whether the keyboard is in use, so that the cursor shows. */
  readonly byKeyboard = signal(false);
  readonly editing = signal<edits.EditSession | undefined>(undefined);
  readonly paths = signal<ReadonlyMap<string, paths.PathSession>>(new Map());
  /** What is left of each robot's path. */
  readonly ahead = signal<ReadonlyMap<string, readonly Cell[]>>(new Map());
  /** Accepted changes of goals, oldest first: what undo takes back. */
  readonly goalChanges = signal<readonly GoalChange[]>([]);
  readonly rectangle = signal<Rectangle | undefined>(undefined);
  readonly sendAtRelease = signal(true);
  readonly layersOpen = signal(false);
  /** Whether the map is shown in three dimensions, to look at only. */
  readonly solid = signal(false);
  /** Short message why something was not done; a new object each time. */
  readonly note = signal<Note | undefined>(undefined);

  readonly #seen = new SeenTogether();
  readonly #wallsKnown = keptFor(wallsKnown);
  readonly #differences = keptFor(differencesOf);
  #given = new Map<string, Guidance>();
  #fitted = true;
  /** By world: drafts are kept while another world is shown. */
  #sessions = new Map<string, edits.EditSession>();
  #sentEdits = new Map<string, number>();
  #sentPaths = new Map<string, number>();

  constructor(props: MapProps) {
    this.props = signal(props);
    let kept = props;
    this.calm = computed(() => {
      const now = this.props.value;
      if (!onlyMoves(kept, now)) kept = now;
      return kept;
    });
    this.#take(props);
  }

  /** Takes new props from the page. */
  update(props: MapProps): void {
    const before = this.props.peek();
    if (sameProps(before, props)) return;
    this.props.value = props;
    this.#take(props);
    const { world } = props;
    if (world.name !== before.world.name) this.cursor.value = undefined;
    if (world.name !== before.world.name || props.tool !== before.tool) {
      this.rectangle.value = undefined;
    }
    if (sizeOf(world) !== sizeOf(before.world)) this.showAll();
    if (props.accept && props.accept.counter !== before.accept?.counter) {
      this.accept(props.accept.changes);
    }
    const view = this.view.peek();
    // A map that is completely visible need not move.
    if (props.focus && props.focus.counter !== before.focus?.counter && view && !this.#fitted) {
      this.lookAt(centreOn(view, props.focus.cell));
    }
  }

  #take(props: MapProps): void {
    this.#takePaths(props);
    if (props.isPast) {
      this.editing.value = undefined;
      return;
    }
    this.#takeBelief(props);
    const before = this.paths.peek();
    const next = new Map(before);
    for (const one of props.robots) {
      const { name } = one.robot;
      if (!one.robot.cell) continue;
      const cell = { row: one.robot.cell.row, column: one.robot.cell.column };
      const kept = before.get(name) ?? paths.newPathSession(name, cell);
      const moved = paths.robotMoved(kept, this.routes, cell);
      next.set(name, paths.guidanceCame(moved, props.guidance.get(name)?.revision ?? 0n));
    }
    const same = [...next].every(([name, path]) => before.get(name) === path);
    if (!same) this.paths.value = next;
  }

  /** A path is used up as its robot drives it, also where it crosses itself, and also if an answer repeats it. */
  #takePaths({ robots, guidance, trails }: MapProps): void {
    const ahead = new Map<string, readonly Cell[]>();
    for (const { robot } of robots) {
      const given = guidance.get(robot.name);
      if (!given) continue;
      const known = this.#given.get(robot.name);
      const newer = known !== undefined && given.revision > known.revision;
      const repeated =
        newer && samePath(known.path, given.path) && !sameCell(given.path[0], robot.cell);
      const before = (known === given || repeated) && this.ahead.peek().get(robot.name);
      const left = before || notDriven(given.path, trails.get(robot.name) ?? []);
      const now = robot.cell ? fromCell(left, robot.cell) : left;
      ahead.set(robot.name, now.length > 1 ? now : []);
      this.#given.set(robot.name, given);
    }
    const known = this.ahead.peek();
    const same =
      ahead.size === known.size && [...ahead].every(([name, path]) => known.get(name) === path);
    if (!same) this.ahead.value = ahead;
  }

  #takeBelief({ belief, world }: MapProps): void {
    const session = belief && this.#sessions.get(world.name);
    this.editing.value = session;
    if (!belief) return;
    const size = { rows: world.rows, columns: world.columns };
    const shown = { world: world.name, revision: belief.revision, walls: belief.walls };
    if (!session) this.#setSession(edits.newEditSession(shown, size));
    else if (session.walls === belief.walls && session.revision === belief.revision)
      this.#setSession(session);
    else this.#setSession(edits.mapConfirmed(session, shown, size));
  }

  // --- View ---

  resize(width: number, height: number): void {
    const view = this.view.peek();
    if (!view || this.#fitted) this.view.value = fitView(this.props.peek().world, width, height);
    else this.lookAt(resized(view, width, height));
  }

  showAll(): void {
    const view = this.view.peek();
    if (view) this.view.value = fitView(this.props.peek().world, view.width, view.height);
    this.#fitted = true;
  }

  /** Sets the view, but never smaller than the whole map needs. */
  lookAt(view: View): void {
    const { world } = this.props.peek();
    const farther = view.scale < (this.view.peek()?.scale ?? 0);
    if (farther && view.scale <= fitView(world, view.width, view.height).scale) {
      this.showAll();
      return;
    }
    this.view.value = keepInSight(view, world);
    this.#fitted = false;
  }

  /** Zooms about `point`, or the middle. */
  zoom(factor: number, point?: Point): void {
    const view = this.view.peek();
    if (!view) return;
    this.lookAt(zoomAbout(view, point ?? { x: view.width / 2, y: view.height / 2 }, factor));
  }

  moveCursor(cell: Cell): void {
    if (!contains(this.props.peek().world, cell)) return;
    this.cursor.value = cell;
    this.byKeyboard.value = true;
    const view = this.view.peek();
    if (!view) return;
    const moved = reveal(view, cell);
    if (moved.x !== view.x || moved.y !== view.y) this.lookAt(moved);
  }

  showNote(text: string): void {
    this.note.value = { text, number: (this.note.peek()?.number ?? 0) + 1 };
  }

  // --- Edits ---

  /** Whether editing is allowed; shows a note if not. */
  mayEdit(): boolean {
    const { mayEdit } = this.props.peek();
    if (!mayEdit.allowed) this.showNote(`Not now: ${mayEdit.reason}.`);
    else if (!this.editing.peek()) this.showNote("Waiting for the map.");
    return mayEdit.allowed && this.editing.peek() !== undefined;
  }

  /** Changes the session of the world shown, if its map has arrived. */
  change(change: (session: edits.EditSession) => edits.EditSession): void {
    const session = this.editing.peek();
    if (session) this.#setSession(change(session));
  }

  /** Sends pending edits of the world shown. Those of another world, or under the past, wait until it is shown again. */
  #setSession(session: edits.EditSession): void {
    const { world, pending } = session;
    this.#sessions.set(world, session);
    const { world: shown, isPast } = this.props.peek();
    if (world !== shown.name || isPast) return;
    this.editing.value = session;
    if (!pending || pending.id === this.#sentEdits.get(world)) return;
    this.#sentEdits.set(world, pending.id);
    const { onEdit } = this.props.peek();
    const cells = edits.changesOf(pending.draft, session.size);
    void answer(onEdit(world, cells, pending.base)).then((outcome) => {
      const now = this.#sessions.get(world);
      if (now) this.#setSession(edits.replied(now, pending.id, outcome));
    });
  }

  /** Changes cells as one edit. */
  accept(changes: readonly CellChange[]): void {
    if (!this.mayEdit()) return;
    for (const wall of [true, false]) {
      const cells = changes.filter((one) => one.wall === wall).map(({ cell }) => cell);
      this.change((session) => edits.paint(session, cells, wall));
    }
    this.endStroke();
  }

  /** Where the operator's map differs from what robots saw. */
  differences(): readonly CellChange[] {
    const { world, belief } = this.props.value;
    return belief ? this.#differences(belief.walls, this.seen, world) : [];
  }

  endStroke(): void {
    this.change((session) => edits.endStroke(session, this.props.peek().editLimit));
  }

  // --- Paths ---

  /** What all robots have seen. */
  get seen(): Uint8Array {
    const { world, seen } = this.props.peek();
    return this.#seen.cells(world, [...seen.values()]);
  }

  /** Worked out when it is first used. Participants may not know what robots saw. */
  get routes(): RouteGrid {
    const props = this.props.peek();
    const { size, walls } = gridOf(props);
    if (props.participates) return { size, walls };
    const known = () => this.#wallsKnown(walls, this.seen, size);
    return {
      size,
      get walls() {
        return known();
      },
    };
  }

  assess(cells: readonly Cell[]): Assessment {
    const { world, seen } = this.props.value;
    return assess(cells, gridOf(this.props.value), world.cellSize, seen);
  }

  mayGuide(): boolean {
    const { mayGuide } = this.props.peek();
    if (!mayGuide.allowed) this.showNote(`Not now: ${mayGuide.reason}.`);
    return mayGuide.allowed;
  }

  changePath(robot: string, change: (session: paths.PathSession) => paths.PathSession): void {
    const before = this.paths.peek().get(robot);
    if (!before) return;
    const session = change(before);
    this.paths.value = new Map([...this.paths.peek(), [robot, session]]);
    const { sent } = session;
    if (!sent || sent.id <= (this.#sentPaths.get(robot) ?? 0)) return;
    this.#sentPaths.set(robot, sent.id);
    const { onPath } = this.props.peek();
    void answer(onPath(robot, sent.cells)).then((outcome) =>
      this.changePath(robot, (now) => paths.replied(now, sent.id, outcome)),
    );
  }
}

function fromCell(path: readonly Cell[], at: Cell): readonly Cell[] {
  const reached = path.findIndex((cell) => sameCell(cell, at));
  return reached > 0 ? path.slice(reached) : path;
}

/** What is left of a path after the cells of `trail`, which the robot entered since it was last where the path begins. */
function notDriven(path: readonly Cell[], trail: readonly Cell[]): readonly Cell[] {
  const begins = trail.findLastIndex((cell) => sameCell(cell, path[0]));
  return begins < 0 ? path : trail.slice(begins).reduce(fromCell, path);
}

function samePath(one: readonly Cell[] | undefined, other: readonly Cell[]): boolean {
  return (
    one === other ||
    (one?.length === other.length && one.every((cell, index) => sameCell(cell, other[index])))
  );
}

function sizeOf({ name, rows, columns }: MapProps["world"]): string {
  return `${name} ${rows} ${columns}`;
}

function gridOf({ world, belief }: MapProps): RouteGrid {
  const size = { rows: world.rows, columns: world.columns };
  return { size, walls: belief?.walls ?? new Uint8Array(world.rows * world.columns) };
}

function answer(outcome: Promise<Outcome>): Promise<Outcome> {
  return outcome.catch((error: unknown) => ({ accepted: false, reason: String(error) }));
}

/** What changes with every report of a robot. */
const moving: ReadonlySet<string> = new Set([
  "robots",
  "world", // its time
  "seen",
  "trails",
  "plans",
  "searches",
  "predictions",
] satisfies (keyof MapProps)[]);

/** Whether robots moved on and nothing else changed. */
function onlyMoves(before: MapProps, now: MapProps): boolean {
  const other = new Map<string, unknown>(Object.entries(before));
  return (
    before.robots.length === now.robots.length &&
    sizeOf(before.world) === sizeOf(now.world) &&
    Object.entries(now).every(([key, value]) => moving.has(key) || other.get(key) === value)
  );
}

function sameProps(a: MapProps, b: MapProps): boolean {
  const other = new Map<string, unknown>(Object.entries(b));
  const entries = Object.entries(a);
  return entries.length === other.size && entries.every(([key, value]) => other.get(key) === value);
}
