import type { TextStorage } from "../connection/browser_storage";
import { defaultLayers, type LayerName, type Layers, layerNames } from "../map/map_props";

export type Theme = "system" | "dark" | "light";

/** Display settings, kept in the browser. */
export interface Settings {
  readonly layers: Layers;
  readonly theme: Theme;
  /** Whether these panels are open. */
  readonly workload: boolean;
  readonly events: boolean;
  readonly fleet: boolean;
  /** Groups of robots that the person made, by name. */
  readonly groups: Readonly<Record<string, readonly string[]>>;
  /** Whether alarms and lost stops are heard. */
  readonly sound: boolean;
}

export const defaultSettings: Settings = {
  layers: defaultLayers,
  theme: "system",
  workload: false,
  events: false,
  fleet: false,
  groups: {},
  sound: true,
};

const key = "conav.settings";

export function readSettings(storage: Pick<TextStorage, "getItem">): Settings {
  try {
    return toSettings(JSON.parse(storage.getItem(key) ?? "{}"));
  } catch {
    return defaultSettings;
  }
}

export function writeSettings(storage: Pick<TextStorage, "setItem">, settings: Settings): void {
  storage.setItem(key, JSON.stringify(settings));
}

function toSettings(value: unknown): Settings {
  const theme = member(value, "theme");
  return {
    layers: toLayers(member(value, "layers")),
    theme: theme === "dark" || theme === "light" ? theme : "system",
    workload: member(value, "workload") === true,
    events: member(value, "events") === true,
    fleet: member(value, "fleet") === true,
    groups: toGroups(member(value, "groups")),
    sound: member(value, "sound") !== false,
  };
}

function toGroups(value: unknown): Settings["groups"] {
  const entries = typeof value === "object" && value !== null ? Object.entries(value) : [];
  return Object.fromEntries(
    entries.flatMap(([name, robots]) =>
      Array.isArray(robots) ? [[name, robots.filter((robot) => typeof robot === "string")]] : [],
    ),
  );
}

/** A layer without a stored value, such as a new one, gets its default. */
function toLayers(value: unknown): Layers {
  const layers: Record<LayerName, number> = { ...defaultLayers };
  for (const name of layerNames) {
    const kept = Number(member(value, name));
    if (kept >= 0 && kept <= 1) layers[name] = kept;
  }
  return layers;
}

function member(value: unknown, name: string): unknown {
  return typeof value === "object" && value !== null
    ? Object.entries(value).find(([other]) => other === name)?.[1]
    : undefined;
}
