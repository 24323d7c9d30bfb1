import type { MapModel } from "../map_model";
import { draftLayers, dropRefused, sendAgain } from "./edit_session";

/** How the edits stand that the service has not confirmed; a refused one waits for a decision. */
export function EditNotes({ model }: { model: MapModel }) {
  const session = model.editing.value;
  if (!session) return undefined;
  const { pending } = draftLayers(session);
  const waiting = pending.reduce((sum, draft) => sum + draft.size, 0);
  const { refused } = session;
  return (
    <>
      {waiting > 0 && (
        <p class="map-note-card" role="status">
          {cellCount(waiting)} sent, not confirmed yet
        </p>
      )}
      {refused && (
        <div class="map-note-card refused" role="alert">
          <p>
            <strong>{cellCount(refused.draft.size)} not saved:</strong> {refused.reason}. Look at
            the newest map, then:
          </p>
          <button
            type="button"
            class="main"
            disabled={!model.props.value.mayEdit.allowed}
            onClick={() => model.change(sendAgain)}
          >
            Send again
          </button>
          <button type="button" onClick={() => model.change(dropRefused)}>
            Drop
          </button>
        </div>
      )}
    </>
  );
}

function cellCount(count: number): string {
  return `${count} ${count === 1 ? "cell" : "cells"}`;
}
