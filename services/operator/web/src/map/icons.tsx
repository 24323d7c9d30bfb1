import {
  Box,
  BrickWall,
  Eraser,
  Flag,
  Hand,
  Layers,
  Maximize,
  Minus,
  Plus,
  Redo2,
  Spline,
  SquareDashed,
  Undo2,
} from "lucide-preact";
import type { ComponentChildren } from "preact";
import type { LayerName } from "./map_props";

export const icons = {
  look: <Hand size={16} />,
  wall: <BrickWall size={16} />,
  erase: <Eraser size={16} />,
  rectangle: <SquareDashed size={16} />,
  goal: <Flag size={16} />,
  path: <Spline size={16} />,
  undo: <Undo2 size={16} />,
  redo: <Redo2 size={16} />,
  plus: <Plus size={16} />,
  minus: <Minus size={16} />,
  fit: <Maximize size={16} />,
  layers: <Layers size={16} />,
  solid: <Box size={16} />,
} as const;

/** Symbols in 16 x 12. The layers without one have colours in map.css. */
const signs: Partial<Record<LayerName, ComponentChildren>> = {
  plan: (
    <>
      <circle class="solid" cx="3" cy="6" r="2.4" />
      <circle class="solid" cx="8.5" cy="6" r="1.8" />
      <circle class="solid" cx="13.2" cy="6" r="1.2" />
    </>
  ),
  search: <path d="M8 11V2M5 5l3-3 3 3M2 9h3M11 9h3" />,
  trails: (
    <>
      <path d="M2 10V4h7V8h5" />
      <circle class="solid" cx="2" cy="10" r="1.6" />
    </>
  ),
  pictures: <path d="M2 6 13 1q2 5 0 10z" />,
  goals: <path class="filled" d="M4 11.5V1l8 2.5L4 6" />,
  paths: <path class="thick" d="M1.5 10h7V4.5h4.5M10.5 1.8 13.3 4.5 10.5 7.2" />,
  goalPoses: <path d="M8 2.5a3.5 3.5 0 1 0 .01 0M8 0v4M8 8v4M2 6h4M10 6h4" />,
};

/** A sample of a layer's look. */
export function LayerSwatch({ name }: { name: LayerName }) {
  const sign = signs[name];
  return sign === undefined ? (
    <span class={`map-swatch of-${name}`} aria-hidden="true" />
  ) : (
    <svg class="map-swatch map-icon" viewBox="0 0 16 12" aria-hidden="true">
      {sign}
    </svg>
  );
}
