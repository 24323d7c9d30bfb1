import type { Signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { icons, LayerSwatch } from "./icons";
import { type LayerName, type Layers, layerNames } from "./map_props";

const layerTexts: Record<LayerName, string> = {
  belief: "Your map",
  changes: "Your changes",
  seen: "Seen by robots",
  heat: "Expected edits",
  plan: "Robots' plans",
  search: "Search visits",
  trails: "Robots' trails",
  pictures: "Pictures",
  goals: "Goals",
  paths: "Paths given",
  goalPoses: "Goal poses",
  truth: "True map",
};

/** Layers that participants may see. */
const participantLayers: ReadonlySet<LayerName> = new Set([
  "belief",
  "changes",
  "trails",
  "pictures",
  "goals",
  "paths",
]);

export function LayersMenu(props: {
  layers: Layers;
  onLayers: (layers: Layers) => void;
  hasTruth: boolean;
  /** As in MapProps. */
  participates: boolean;
  open: Signal<boolean>;
}) {
  const { layers, onLayers, hasTruth, participates, open } = props;
  const place = useRef<HTMLDivElement>(null);
  useCloseOutside(place, open);
  return (
    <div class="map-layers" ref={place}>
      <button
        type="button"
        class="map-tool"
        aria-expanded={open.value}
        aria-keyshortcuts="L"
        title="What the map shows (L)"
        onClick={() => {
          open.value = !open.peek();
        }}
      >
        {icons.layers}
        <span>Layers</span>
        <kbd>L</kbd>
      </button>
      {open.value && (
        <fieldset class="map-layer-list">
          <legend>Show on the map</legend>
          {layerNames
            .filter((name) => hasTruth || name !== "truth")
            .filter((name) => !participates || participantLayers.has(name))
            .map((name) => (
              <LayerRow
                key={name}
                name={name}
                strength={layers[name]}
                onStrength={(strength) => onLayers({ ...layers, [name]: strength })}
              />
            ))}
        </fieldset>
      )}
    </div>
  );
}

interface RowProps {
  name: LayerName;
  strength: number;
  onStrength: (strength: number) => void;
}

/** Switch and opacity of a layer. */
function LayerRow({ name, strength, onStrength }: RowProps) {
  return (
    <div class="map-layer-row">
      <label>
        <input
          type="checkbox"
          checked={strength > 0}
          onChange={(event) => onStrength(event.currentTarget.checked ? 1 : 0)}
        />
        <LayerSwatch name={name} />
        {layerTexts[name]}
      </label>
      <input
        type="range"
        min={0.1}
        max={1}
        step={0.1}
        value={strength}
        disabled={strength === 0}
        aria-label={`Opacity: ${layerTexts[name]}`}
        title="Opacity"
        onInput={(event) => onStrength(event.currentTarget.valueAsNumber)}
      />
    </div>
  );
}

/** Closes on Escape or a press elsewhere. Opening focuses the first layer. */
function useCloseOutside(place: { current: HTMLDivElement | null }, open: Signal<boolean>): void {
  const isOpen = open.value;
  useEffect(() => {
    if (!isOpen) return undefined;
    place.current?.querySelector("input")?.focus();
    const ended = new AbortController();
    const close = () => {
      open.value = false;
    };
    const outside = (event: PointerEvent) => {
      if (!(event.target instanceof Node && place.current?.contains(event.target))) close();
    };
    const key = (event: KeyboardEvent) => {
      if (event.key !== "Escape") return;
      event.preventDefault();
      close();
    };
    const options = { signal: ended.signal, capture: true };
    window.addEventListener("pointerdown", outside, options);
    window.addEventListener("keydown", key, options);
    return () => {
      ended.abort();
      // If the menu had the focus, its button gets it.
      if (document.activeElement === document.body) place.current?.querySelector("button")?.focus();
    };
  }, [isOpen, open, place]);
}
