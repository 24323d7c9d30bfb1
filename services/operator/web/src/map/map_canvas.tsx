import { effect, type ReadonlySignal, useComputed } from "@preact/signals";
import { useEffect, useId, useLayoutEffect, useMemo, useRef } from "preact/hooks";
import { showOn } from "./canvas_view";
import { dropRefused, sendAgain } from "./edit_session";
import { mapId } from "./focus";
import { GoalBar } from "./goal_bar";
import { MapModel } from "./map_model";
import type { MapProps } from "./map_props";
import { PathBar } from "./path/path_bar";
import { hasDraft } from "./path/path_session";
import { SolidView } from "./solid/solid_view";
import { StatusLine } from "./status_line";
import { ToolDriver } from "./tool_driver";
import { Toolbar } from "./toolbar";
import "./map.css";

/**
 * The operator's map of one world, with its tools. Fills its parent element, which must have a size. `view` changes with every
 * report of a robot, which is drawn without another look at the elements around the map.
 */
export function MapCanvas({ view }: { view: ReadonlySignal<MapProps> }) {
  const model = useMemo(() => new MapModel(view.peek()), []);
  const driver = useMemo(() => new ToolDriver(model), [model]);
  const canvas = useRef<HTMLCanvasElement>(null);
  const help = useId();
  useLayoutEffect(() => effect(() => model.update(view.value)), [model, view]);
  const props = model.calm.value;
  useEffect(() => {
    return canvas.current ? showOn(canvas.current, model, driver) : undefined;
  }, [model, driver]);
  return (
    <section class="map-root" aria-label={`Map of ${props.world.name}`}>
      <Toolbar model={model} />
      <div class="map-stage">
        {/* biome-ignore lint/a11y/noInteractiveElementToNoninteractiveRole: it handles its own keys, like an application */}
        <canvas
          ref={canvas}
          id={mapId}
          class={`map-surface tool-${props.tool}`}
          tabIndex={0}
          role="application"
          aria-label={`Your map of ${props.world.name}, ${props.world.rows} rows, ${props.world.columns} columns`}
          aria-describedby={help}
        />
        <SolidView model={model} />
      </div>
      {!props.readOnly && <ToolBar model={model} driver={driver} />}
      <p id={help} class="map-unseen">
        {props.arrowsDrive
          ? "Arrow keys drive the robot. With the tools W, E and R they move a cell cursor. Space uses the tool at the cursor. Escape returns to driving."
          : "Arrow keys move a cell cursor. Space uses the tool at the cursor. V, W, E, R, P and O choose the tool."}
      </p>
      <StatusLine model={model} />
    </section>
  );
}

/** One bar for whatever the tool has to say, so that the map does not move when that changes. */
function ToolBar({ model, driver }: { model: MapModel; driver: ToolDriver }) {
  const { tool, chosenRobot } = model.calm.value;
  const draft = model.paths.value.get(chosenRobot ?? "");
  return (
    <div class="map-notes">
      {model.editing.value?.refused ? (
        <RefusedEdit model={model} />
      ) : tool === "path" || (draft && hasDraft(draft)) ? (
        <PathBar model={model} driver={driver} />
      ) : tool === "goal" ? (
        <GoalBar model={model} />
      ) : (
        <div class="map-card">
          <p class="quiet">{hints[tool]}</p>
          <AcceptAll model={model} />
        </div>
      )}
    </div>
  );
}

/** Not for participants, who find the differences. */
function AcceptAll({ model }: { model: MapModel }) {
  const { participates, mayEdit } = model.calm.value;
  const differences = useComputed(() => model.differences()).value;
  const changes = participates ? [] : differences;
  if (changes.length === 0) return undefined;
  return (
    <button
      type="button"
      disabled={!mayEdit.allowed}
      title="Changes your map to what robots saw. Undo takes it back."
      onClick={() => model.accept(changes)}
    >
      Accept what robots saw ({changes.length} {changes.length === 1 ? "cell" : "cells"})
    </button>
  );
}

const hints = {
  look: "Drag to move the map, scroll to zoom, click to choose a robot.",
  wall: "Drag to draw walls. Shift erases.",
  erase: "Drag over walls that are not there.",
  rectangle: "Drag from corner to corner. Shift erases.",
} as const;

/** A refused edit: the person sends it again or discards it. */
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
        {refused.reason}. Check the newest map, then choose:
      </p>
      <button
        type="button"
        class="main"
        disabled={!model.calm.value.mayEdit.allowed}
        onClick={() => model.change(sendAgain)}
      >
        Send again
      </button>
      <button type="button" onClick={() => model.change(dropRefused)}>
        Discard
      </button>
    </div>
  );
}
