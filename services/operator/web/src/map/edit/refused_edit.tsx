import type { MapModel } from "../map_model";
import { dropRefused, sendAgain } from "./edit_session";

/** An edit that the service has refused: it waits for a decision. */
export function RefusedEdit({ model }: { model: MapModel }) {
  const refused = model.editing.value?.refused;
  if (!refused) return undefined;
  const count = refused.draft.size;
  return (
    <div class="map-card refused" role="alert">
      <p>
        <strong>
          {count} {count === 1 ? "cell" : "cells"} not saved:
        </strong>{" "}
        {refused.reason}. Look at the newest map, then:
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
  );
}
