import { useComputed } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import { readPalette, watchTheme } from "../draw/palette";
import type { MapModel } from "../map_model";
import { type SolidData, wallsOf } from "./solid_data";
import type { SolidScene } from "./solid_scene";

/** The world in three dimensions over the map: to look at, the map stays as it is. The library for it is loaded when it is opened. */
export function SolidView({ model }: { model: MapModel }) {
  return model.solid.value ? <OpenView model={model} /> : undefined;
}

function OpenView({ model }: { model: MapModel }) {
  const place = useRef<HTMLDivElement>(null);
  const scene = useRef<SolidScene | undefined>(undefined);
  const [problem, setProblem] = useState("Loading…");
  const [theme, setTheme] = useState(0);
  const data = useComputed(() => dataOf(model));
  useEffect(() => watchTheme(() => setTheme((before) => before + 1)), []);
  useEffect(() => {
    let gone = false;
    const open = async () => {
      const { SolidScene: Scene } = await import("./solid_scene");
      if (gone || !place.current) return;
      scene.current = new Scene(place.current, readPalette(place.current));
      scene.current.show(data.peek());
      setProblem("");
    };
    open().catch((error: unknown) => setProblem(`Cannot show three dimensions: ${error}`));
    return () => {
      gone = true;
      scene.current?.end();
      scene.current = undefined;
    };
  }, [data, theme]);
  const now = data.value;
  useEffect(() => scene.current?.show(now), [now]);
  return (
    <div
      ref={place}
      class="map-solid"
      role="img"
      aria-label={`${model.calm.value.world.name} in three dimensions. Drag to turn, scroll to zoom.`}
    >
      {problem !== "" ? <p class="quiet">{problem}</p> : <Legend />}
    </div>
  );
}

function Legend() {
  return (
    <ul class="map-solid-legend">
      <li class="of-belief">on your map</li>
      <li class="of-confirmed">robots saw it, too</li>
      <li class="of-refuted">robots saw no wall</li>
      <li class="of-missing">missing on your map</li>
    </ul>
  );
}

function dataOf(model: MapModel): SolidData {
  const { world, belief, robots, pictures, chosenRobot } = model.props.value;
  const size = { rows: world.rows, columns: world.columns };
  return {
    world: { ...size, cellSize: world.cellSize, middleX: world.middleX, middleY: world.middleY },
    walls: wallsOf(size, belief?.walls, model.seen),
    robots,
    chosenRobot,
    newest: robots.flatMap(
      ({ robot }) => pictures.findLast((picture) => picture.robot === robot.name) ?? [],
    ),
    paths: model.ahead.value,
  };
}
