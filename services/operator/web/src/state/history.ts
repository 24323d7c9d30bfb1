import { create } from "@bufbuild/protobuf";
import { signal } from "@preact/signals";
import { type Mark, MarkKind, MarkSchema } from "../protocol/generated/console_pb";
import type { ConsoleState } from "./console_state";

/** What the page showed at a time. */
export interface Moment {
  /** Wall time of the service. */
  readonly time: number;
  readonly state: ConsoleState;
}

/** s between two moments. */
const period = 0.5;
/** Bytes of grids that moments may keep; robots and the rest are small. */
const budget = 32e6;
const mostMoments = 4000;

/**
 * What the page showed since it was opened. States share what did not change, so a moment costs little more than what changed
 * since the one before it. Where the moments cost too much, every second one of the older half is dropped.
 */
export class History {
  /** Wall times of the first and the newest moment, in whole s. */
  readonly span = signal<{ readonly from: number; readonly to: number }>({ from: 0, to: 0 });
  /** Goals that robots reached. */
  readonly goals = signal<readonly Mark[]>([]);
  #moments: Moment[] = [];
  #bytes = 0;

  get length(): number {
    return this.#moments.length;
  }

  /** `budgetBytes`: for tests. */
  add(state: ConsoleState, time: number, budgetBytes = budget): void {
    const newest = this.#moments.at(-1);
    // A restarted service begins a new run.
    if (newest && newest.state.run !== state.run) this.#forget();
    else if (newest && time - newest.time < period) return;
    const before = this.#moments.at(-1)?.state;
    this.#bytes += bytesChanged(before, state);
    this.#moments.push({ time, state: { ...state, isPast: true } });
    if (this.#bytes > budgetBytes || this.#moments.length > mostMoments) this.#thin();
    const reached = before ? goalsReached(before, state, time) : [];
    if (reached.length > 0) this.goals.value = [...this.goals.value, ...reached];
    const span = { from: Math.floor(this.#moments[0]?.time ?? time), to: Math.floor(time) };
    if (span.from !== this.span.value.from || span.to !== this.span.value.to)
      this.span.value = span;
  }

  /** The moment at `time`, or the last before it; the first one if all are later. */
  at(time: number): Moment | undefined {
    return this.#moments.findLast((moment) => moment.time <= time) ?? this.#moments[0];
  }

  #forget(): void {
    this.#moments = [];
    this.#bytes = 0;
    this.goals.value = [];
  }

  #thin(): void {
    const half = this.#moments.length / 2;
    this.#moments = this.#moments.filter((_, i) => i > half || i % 2 === 0);
    this.#bytes = 0;
    for (const [i, { state }] of this.#moments.entries()) {
      this.#bytes += bytesChanged(this.#moments[i - 1]?.state, state);
    }
  }
}

export function mark(kind: MarkKind, position: number, robot: string, text: string): Mark {
  return create(MarkSchema, { kind, position, robot, text });
}

function goalsReached(before: ConsoleState, now: ConsoleState, time: number): readonly Mark[] {
  return [...now.robots.values()].flatMap(({ name, goalsReached: { length }, goalsTotal }) => {
    const known = before.robots.get(name)?.goalsReached.length ?? length;
    const text = `${name} reached goal ${length} of ${goalsTotal}`;
    return length > known ? [mark(MarkKind.MARK_GOAL, time, name, text)] : [];
  });
}

function bytesChanged(before: ConsoleState | undefined, now: ConsoleState): number {
  let bytes = 0;
  for (const [robot, { cells }] of now.seen) {
    if (before?.seen.get(robot)?.cells !== cells) bytes += cells.length;
  }
  for (const [world, { walls }] of now.beliefs) {
    if (before?.beliefs.get(world)?.walls !== walls) bytes += walls.length;
  }
  for (const [robot, { jpeg }] of now.frames) {
    if (before?.frames.get(robot)?.jpeg !== jpeg) bytes += jpeg.length;
  }
  for (const [robot, { add, remove }] of now.predictions) {
    if (before?.predictions.get(robot)?.add !== add) bytes += add.length + remove.length;
  }
  return bytes;
}
