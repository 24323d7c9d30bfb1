// Edits of the operator's map, as a pure state machine. A stroke is drawn, then queued, then sent as one edit based on the
// revision that the service has confirmed. It is saved when the service has both accepted it and sent a newer revision.
// Only one edit is pending at a time, because each builds on the revision of the one before. A refused edit stays as a
// draft until the person sends it again or discards it.

import { cellIndex, cellOfIndex, contains, type GridSize, isWallAt, onBorder } from "./grid";
import type { Cell, CellChange, Outcome } from "./map_props";

/** Wanted values by cell index; true = wall. */
export type Draft = ReadonlyMap<number, boolean>;

type StepCell = { index: number; before: boolean; after: boolean };

/** The changes of one edit, enough to undo it. */
type Step = readonly StepCell[];

type Job = { kind: "stroke"; draft: Draft } | { kind: "undo" } | { kind: "redo" };

type PendingEdit = {
  readonly id: number;
  readonly kind: Job["kind"];
  readonly step: Step; // the original change, also for undo and redo
  readonly draft: Draft;
  readonly base: bigint;
  readonly accepted: boolean;
};

export type RefusedEdit = { readonly draft: Draft; readonly reason: string };

export type EditSession = {
  readonly world: string;
  readonly size: GridSize;
  readonly revision: bigint;
  readonly walls: Uint8Array; // as the service has confirmed them
  readonly stroke: Draft; // being drawn
  readonly queue: readonly Job[];
  readonly pending: PendingEdit | undefined; // to be sent, or sent
  readonly refused: RefusedEdit | undefined;
  readonly undo: readonly Step[];
  readonly redo: readonly Step[];
  readonly lastId: number;
};

type ConfirmedMap = { world: string; revision: bigint; walls: Uint8Array };

const nothing: Draft = new Map();

export function newEditSession(map: ConfirmedMap, size: GridSize, lastId = 0): EditSession {
  return {
    ...map,
    size,
    stroke: nothing,
    queue: [],
    pending: undefined,
    refused: undefined,
    undo: [],
    redo: [],
    lastId,
  };
}

/** Another maze or a restarted service starts from scratch. Ids of pending edits never repeat. */
export function mapConfirmed(session: EditSession, map: ConfirmedMap, size: GridSize): EditSession {
  const { rows, columns } = session.size;
  const isOther = map.world !== session.world || rows !== size.rows || columns !== size.columns;
  if (isOther || map.revision < session.revision) {
    return newEditSession(map, size, session.lastId);
  }
  return advance(rebased({ ...session, ...map, size }));
}

export function paint(session: EditSession, cells: readonly Cell[], wall: boolean): EditSession {
  const stroke = new Map(session.stroke);
  for (const cell of cells) {
    if (mayChange(session.size, cell)) stroke.set(cellIndex(session.size, cell), wall);
  }
  return { ...session, stroke };
}

export function mayChange(size: GridSize, cell: Cell): boolean {
  return contains(size, cell) && !onBorder(size, cell);
}

export function cancelStroke(session: EditSession): EditSession {
  return { ...session, stroke: nothing };
}

/** Queues the finished stroke, in parts of at most `limit` cells. */
export function endStroke(
  session: EditSession,
  limit: number = Number.POSITIVE_INFINITY,
): EditSession {
  const jobs = parts(session.stroke, limit).map((draft): Job => ({ kind: "stroke", draft }));
  const refused = session.refused && without(session.refused, session.stroke);
  return advance({ ...session, stroke: nothing, refused, queue: [...session.queue, ...jobs] });
}

function parts(draft: Draft, limit: number): Draft[] {
  const entries = [...draft];
  const size = Math.max(1, Math.min(limit, entries.length));
  const count = Math.ceil(entries.length / size);
  return Array.from(
    { length: count },
    (_, part) => new Map(entries.slice(part * size, (part + 1) * size)),
  );
}

export function undo(session: EditSession): EditSession {
  return canUndo(session)
    ? advance({ ...session, queue: [...session.queue, { kind: "undo" }] })
    : session;
}

export function redo(session: EditSession): EditSession {
  return canRedo(session)
    ? advance({ ...session, queue: [...session.queue, { kind: "redo" }] })
    : session;
}

/** Counts edits that are still pending, too. */
export function canUndo(session: EditSession): boolean {
  return session.undo.length + underWay(session, "stroke", "redo") > underWay(session, "undo");
}

export function canRedo(session: EditSession): boolean {
  if (underWay(session, "stroke") > 0) return false;
  return session.redo.length + underWay(session, "undo") > underWay(session, "redo");
}

function underWay(session: EditSession, ...kinds: Job["kind"][]): number {
  const jobs: { kind: Job["kind"] }[] = [...session.queue];
  if (session.pending) jobs.push(session.pending);
  return jobs.filter((job) => kinds.includes(job.kind)).length;
}

/** The service's reply to the pending edit. Replies to earlier edits are ignored. */
export function replied(session: EditSession, id: number, outcome: Outcome): EditSession {
  const pending = session.pending;
  if (pending?.id !== id) return session;
  if (outcome.accepted) {
    return advance({ ...session, pending: { ...pending, accepted: true } });
  }
  const draft = new Map([...(session.refused?.draft ?? []), ...pending.draft]);
  const refused = { draft, reason: outcome.reason || "the service refused the edit" };
  return advance(rebased({ ...session, pending: undefined, refused }));
}

export function sendAgain(session: EditSession): EditSession {
  if (!session.refused) return session;
  const job: Job = { kind: "stroke", draft: session.refused.draft };
  return advance({ ...session, refused: undefined, queue: [...session.queue, job] });
}

export function dropRefused(session: EditSession): EditSession {
  return { ...session, refused: undefined };
}

/** Drafts to draw over the confirmed map, bottom first. Later ones may cover a cell again. */
export function draftLayers(session: EditSession): {
  refused: Draft;
  pending: Draft[];
  stroke: Draft;
} {
  const queued = session.queue.flatMap((job) => (job.kind === "stroke" ? [job.draft] : []));
  return {
    refused: session.refused?.draft ?? nothing,
    pending: session.pending ? [session.pending.draft, ...queued] : queued,
    stroke: session.stroke,
  };
}

export function changesOf(draft: Draft, size: GridSize): CellChange[] {
  return [...draft].map(([index, wall]) => ({ cell: cellOfIndex(size, index), wall }));
}

/** Removes from the refused draft what the confirmed map already has. */
function rebased(session: EditSession): EditSession {
  if (!session.refused) return session;
  const already = new Map(
    [...session.refused.draft].filter(([index, wall]) => isWallAt(session.walls, index) === wall),
  );
  return { ...session, refused: without(session.refused, already) };
}

function without(refused: RefusedEdit, gone: Draft): RefusedEdit | undefined {
  const draft = new Map([...refused.draft].filter(([index]) => !gone.has(index)));
  return draft.size > 0 ? { ...refused, draft } : undefined;
}

/** Settles a confirmed edit and starts the next job. Jobs that change nothing are dropped. */
function advance(session: EditSession): EditSession {
  let now = settled(session);
  while (!now.pending) {
    const [job, ...queue] = now.queue;
    if (!job) return now;
    now = taken({ ...now, queue }, job);
  }
  return now;
}

function settled(session: EditSession): EditSession {
  const pending = session.pending;
  if (!pending?.accepted || session.revision <= pending.base) return session;
  const done = { ...session, pending: undefined };
  if (pending.kind === "undo") {
    return { ...done, undo: session.undo.slice(0, -1), redo: [...session.redo, pending.step] };
  }
  if (pending.kind === "redo") {
    return { ...done, redo: session.redo.slice(0, -1), undo: [...session.undo, pending.step] };
  }
  return { ...done, undo: [...session.undo, pending.step], redo: [] };
}

function taken(session: EditSession, job: Job): EditSession {
  if (job.kind === "stroke") {
    const step = [...job.draft].map(([index, after]) => {
      return { index, before: isWallAt(session.walls, index), after };
    });
    return begun(session, job.kind, changing(step));
  }
  const step = session[job.kind].at(-1);
  if (!step) return session;
  const left = changing(step).filter(
    (cell) =>
      isWallAt(session.walls, cell.index) === (job.kind === "undo" ? cell.after : cell.before),
  );
  if (left.length > 0) return begun(session, job.kind, left);
  // Others have changed all of it since: nothing to undo, continue with the previous step.
  return taken({ ...session, [job.kind]: session[job.kind].slice(0, -1) }, job);
}

function changing(step: Step): Step {
  return step.filter((cell) => cell.before !== cell.after);
}

function begun(session: EditSession, kind: Job["kind"], step: Step): EditSession {
  if (step.length === 0) return session;
  const id = session.lastId + 1;
  const draft = new Map(
    step.map((cell) => [cell.index, kind === "undo" ? cell.before : cell.after] as const),
  );
  const pending = { id, kind, step, draft, base: session.revision, accepted: false };
  return { ...session, lastId: id, pending };
}
