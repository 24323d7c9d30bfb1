import { type Signal, useComputed } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { inWords } from "../app/words";
import { describeCell } from "./cell_description";
import { draftLayers } from "./edit_session";
import type { MapModel, Note } from "./map_model";
import type { Cell, MapProps } from "./map_props";

/** Describes the cell under the pointer or the cursor. Only the keyboard cursor and notes are read aloud. */
export function StatusLine({ model }: { model: MapModel }) {
  const text = useComputed(() => {
    const cursor = model.byKeyboard.value ? model.cursor.value : undefined;
    const cell = cursor ?? model.hover.value;
    return cell && inWords(textOf(model, cell));
  });
  const aloud = useComputed(() => {
    const cursor = model.byKeyboard.value ? model.cursor.value : undefined;
    return cursor ? inWords(textOf(model, cursor)) : "";
  });
  return (
    <div class="map-status">
      <span>{text}</span>
      <output class="map-unseen">{aloud}</output>
      <span>{pendingText(model)}</span>
      {showsSeen(model.calm.value) && !model.solid.value && <Legend />}
      <NoteLine note={model.note} />
    </div>
  );
}

/** s that a note stays on screen. */
const noteTime = 8;

export function NoteLine({ note }: { note: Signal<Note | undefined> }) {
  const now = note.value;
  useEffect(() => {
    if (now === undefined) return undefined;
    const timer = setTimeout(() => {
      note.value = undefined;
    }, 1000 * noteTime);
    return () => clearTimeout(timer);
  }, [now, note]);
  // A repeated text is a new element, so that it is read aloud again.
  return <output class="map-note">{now && <span key={now.number}>{now.text}</span>}</output>;
}

/** Participants may not know what robots saw. */
function showsSeen({ layers, participates }: MapProps): boolean {
  return layers.seen > 0 && !participates;
}

/** The two symbols that newcomers need: where the map differs from what robots saw. */
function Legend() {
  return (
    <span class="map-legend">
      <svg class="map-swatch map-icon" viewBox="0 0 16 12" aria-hidden="true">
        <path d="M3 1h10v10H3zM3 6l5-5M4 11 13 2M9 11l4-4" />
      </svg>
      robots saw a wall
      <svg class="map-swatch map-icon" viewBox="0 0 16 12" aria-hidden="true">
        <circle cx="8" cy="6" r="4" />
      </svg>
      robots saw no wall
    </span>
  );
}

/** Number of cells that the service has not confirmed. */
function pendingText(model: MapModel): string {
  const session = model.editing.value;
  const drafts = session ? draftLayers(session).pending : [];
  const count = drafts.reduce((sum, draft) => sum + draft.size, 0);
  return count > 0 ? `${count} ${count === 1 ? "cell" : "cells"} sent, not confirmed yet` : "";
}

function textOf(model: MapModel, cell: Cell): string {
  const { world, belief, seen, robots } = model.props.value;
  return describeCell(cell, {
    size: world,
    walls: belief?.walls,
    seen,
    robots: robots.map((one) => one.robot),
  });
}
