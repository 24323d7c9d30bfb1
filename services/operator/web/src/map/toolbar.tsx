import { canRedo, canUndo, redo, undo } from "./edit_session";
import { canUndoGoals, undoGoals } from "./goals";
import { icons } from "./icons";
import { zoomStep } from "./keyboard_input";
import { LayersMenu } from "./layers_menu";
import type { MapModel } from "./map_model";
import { editsMap, offers, type Tool } from "./map_props";

const tools: readonly { tool: Tool; name: string; key: string; hint: string }[] = [
  { tool: "look", name: "Look", key: "V", hint: "drag to move the map, click to choose a robot" },
  { tool: "wall", name: "Wall", key: "W", hint: "draw walls on your map" },
  { tool: "erase", name: "Erase", key: "E", hint: "erase walls" },
  {
    tool: "rectangle",
    name: "Rectangle",
    key: "R",
    hint: "draw a rectangle of walls; with Shift erase",
  },
  { tool: "path", name: "Path", key: "P", hint: "draw the chosen robot's path" },
  { tool: "goal", name: "Goals", key: "O", hint: "set and remove the chosen robot's goals" },
];

export function Toolbar({ model }: { model: MapModel }) {
  const { layers, onLayers, truth, readOnly, participates } = model.calm.value;
  return (
    <fieldset class="map-toolbar" aria-label="Map tools">
      {!readOnly && <ToolButtons model={model} />}
      {!readOnly && <HistoryButtons model={model} />}
      <div class="map-group">
        <Button icon="minus" name="Zoom out" keys="-" onClick={() => model.zoom(1 / zoomStep)} />
        <Button icon="fit" name="Show all" keys="0" onClick={() => model.showAll()} />
        <Button icon="plus" name="Zoom in" keys="+" onClick={() => model.zoom(zoomStep)} />
      </div>
      {!participates && <SolidButton model={model} />}
      <LayersMenu
        layers={layers}
        onLayers={onLayers}
        hasTruth={truth !== undefined}
        participates={participates}
        open={model.layersOpen}
      />
    </fieldset>
  );
}

function SolidButton({ model }: { model: MapModel }) {
  return (
    <button
      type="button"
      class="map-tool"
      aria-pressed={model.solid.value}
      aria-keyshortcuts="3"
      title="The world in three dimensions, to look at (3)"
      onClick={() => {
        model.solid.value = !model.solid.peek();
      }}
    >
      {icons.solid}
      <span>3-D</span>
      <kbd>3</kbd>
    </button>
  );
}

function ToolButtons({ model }: { model: MapModel }) {
  const { tool: chosen, onTool, mayEdit } = model.calm.value;
  const offered = tools.filter(({ tool }) => offers(model.calm.value, tool));
  return (
    <div class="map-group">
      {offered.map(({ tool, name, key, hint }) => {
        const reason = editsMap(tool) && !mayEdit.allowed ? ` Not now: ${mayEdit.reason}.` : "";
        return (
          <button
            type="button"
            class="map-tool"
            key={tool}
            aria-pressed={tool === chosen}
            aria-keyshortcuts={key}
            title={`${name} (${key}): ${hint}.${reason}`}
            onClick={() => onTool(tool)}
          >
            {icons[tool]}
            <span>{name}</span>
            <kbd>{key}</kbd>
          </button>
        );
      })}
    </div>
  );
}

function HistoryButtons({ model }: { model: MapModel }) {
  const { tool, mayEdit, mayGuide } = model.calm.value;
  if (tool === "goal") {
    const disabled = !mayGuide.allowed || !canUndoGoals(model);
    return (
      <div class="map-group">
        <Button
          icon="undo"
          name="Undo goal"
          keys="Ctrl+Z"
          disabled={disabled}
          onClick={() => void undoGoals(model)}
        />
      </div>
    );
  }
  const session = model.editing.value;
  const allowed = session !== undefined && mayEdit.allowed;
  return (
    <div class="map-group">
      <Button
        icon="undo"
        name="Undo"
        keys="Ctrl+Z"
        disabled={!allowed || !canUndo(session)}
        onClick={() => model.change(undo)}
      />
      <Button
        icon="redo"
        name="Redo"
        keys="Ctrl+Y"
        disabled={!allowed || !canRedo(session)}
        onClick={() => model.change(redo)}
      />
    </div>
  );
}

function Button(props: {
  icon: keyof typeof icons;
  name: string;
  keys: string;
  disabled?: boolean;
  onClick: () => void;
}) {
  return (
    <button
      type="button"
      class="map-button"
      aria-label={props.name}
      title={`${props.name} (${props.keys})`}
      disabled={props.disabled ?? false}
      onClick={props.onClick}
    >
      {icons[props.icon]}
    </button>
  );
}
