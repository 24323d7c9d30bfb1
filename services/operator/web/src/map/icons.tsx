import type { ComponentChildren } from "preact";
import type { LayerName } from "./map_props";

function Icon({ children }: { children: ComponentChildren }) {
  return (
    <svg class="map-icon" viewBox="0 0 16 16" width="16" height="16" aria-hidden="true">
      {children}
    </svg>
  );
}

/** Line icons in the text's colour (map.css). */
export const icons = {
  look: (
    <Icon>
      <path d="M8 1.5v13M1.5 8h13M6 3.5l2-2 2 2M6 12.5l2 2 2-2M3.5 6l-2 2 2 2M12.5 6l2 2-2 2" />
    </Icon>
  ),
  wall: (
    <Icon>
      <path class="solid" d="M2 3h12v10H2z" />
      <path class="gap" d="M2 6.3h12M2 9.7h12M8 3v3.3M5 6.3v3.4M11 6.3v3.4M8 9.7V13" />
    </Icon>
  ),
  erase: (
    <Icon>
      <path d="M6.5 13.5 2 9l6.5-6.5L14 8l-5.5 5.5zM5 6l5.5 5.5M6 13.5h8.5" />
    </Icon>
  ),
  rectangle: (
    <Icon>
      <path d="M2.5 3.5h11v9h-11z" />
      <path class="solid" d="M1 2h3v3H1zM12 11h3v3h-3z" />
    </Icon>
  ),
  goal: (
    <Icon>
      <path d="M4 14.5v-13l8.5 3L4 8" />
    </Icon>
  ),
  path: (
    <Icon>
      <path d="M2.5 13.5v-5h6v-5H13M10.5 1l3 2.5-3 2.5" />
      <circle class="solid" cx="2.5" cy="13.2" r="1.6" />
    </Icon>
  ),
  undo: (
    <Icon>
      <path d="M5.5 2.5 2 6l3.5 3.5M2 6h7.5a4 4 0 0 1 0 8H6" />
    </Icon>
  ),
  redo: (
    <Icon>
      <path d="M10.5 2.5 14 6l-3.5 3.5M14 6H6.5a4 4 0 0 0 0 8H10" />
    </Icon>
  ),
  plus: (
    <Icon>
      <path d="M8 3v10M3 8h10" />
    </Icon>
  ),
  minus: (
    <Icon>
      <path d="M3 8h10" />
    </Icon>
  ),
  fit: (
    <Icon>
      <path d="M2 5.5V2h3.5M10.5 2H14v3.5M14 10.5V14h-3.5M5.5 14H2v-3.5" />
    </Icon>
  ),
  layers: (
    <Icon>
      <path d="M8 2 14 5.5 8 9 2 5.5zM2 8.5 8 12l6-3.5M2 11.5 8 15l6-3.5" />
    </Icon>
  ),
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
