import type { MapProps } from "./map_props";

/** Stands in until the map is there. */
export function MapCanvas({ world }: MapProps) {
  return (
    <p class="panel">
      {world.name}: {world.rows} × {world.columns} cells
    </p>
  );
}
