import { describe, expect, it } from "vitest";
import { defaultLayers } from "../map/map_props";
import { defaultSettings, readSettings, writeSettings } from "./settings";

function storage(kept?: string) {
  let text = kept;
  return {
    getItem: () => text ?? null,
    setItem: (_key: string, value: string) => {
      text = value;
    },
  };
}

describe("settings", () => {
  it("come back as they were written", () => {
    const place = storage();
    const layers = { ...defaultLayers, search: 1, heat: 0.3, plan: 0 };
    const settings = {
      layers,
      theme: "light",
      workload: true,
      events: true,
      fleet: true,
      groups: { "north wing": ["r1", "r2"] },
      sound: false,
    } as const;
    writeSettings(place, settings);
    expect(readSettings(place)).toEqual(settings);
  });

  it.each([
    undefined,
    "",
    "no JSON",
    "null",
    "[]",
    '{"theme": 3, "layers": {"plan": "x"}}',
  ])("are the defaults for %s", (kept) => {
    expect(readSettings(storage(kept))).toEqual(defaultSettings);
  });

  it("know layers that were only on or off", () => {
    const { layers } = readSettings(
      storage('{"layers": {"plan": false, "search": true, "heat": 7}}'),
    );
    expect(layers).toMatchObject({ plan: 0, search: 1, heat: defaultLayers.heat });
  });
});
