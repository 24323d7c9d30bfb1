/** The colours of the map. Each is the custom property --map-<name> in map.css, so that themes can set it. */
export const colourNames = [
  "paper", // around the grid
  "free",
  "wall",
  "border", // the outermost cells, which nobody can edit
  "grid",
  "ink",
  "muted",
  "halo", // behind lines and text
  "fog", // over cells that no robot has seen
  "add", // expected: the operator adds a wall
  "remove",
  "changed", // by the operator since the initial map
  "differs", // robots saw something else
  "truth",
  "draft",
  "refused",
  "focus",
] as const;

type ColourName = (typeof colourNames)[number];
export type Palette = Readonly<Record<ColourName, string>>;

/** The colours of the current theme of `element`. */
export function readPalette(element: Element): Palette {
  const style = getComputedStyle(element);
  const read = (name: ColourName) => style.getPropertyValue(`--map-${name}`).trim() || "#808080";
  return paletteFrom(read);
}

export function paletteFrom(read: (name: ColourName) => string): Palette {
  return {
    paper: read("paper"),
    free: read("free"),
    wall: read("wall"),
    border: read("border"),
    grid: read("grid"),
    ink: read("ink"),
    muted: read("muted"),
    halo: read("halo"),
    fog: read("fog"),
    add: read("add"),
    remove: read("remove"),
    changed: read("changed"),
    differs: read("differs"),
    truth: read("truth"),
    draft: read("draft"),
    refused: read("refused"),
    focus: read("focus"),
  };
}

/** Black or white, whichever is more readable on a colour #rrggbb; black on any other. */
export function inkOn(colour: string): string {
  const match = /^#([0-9a-f]{2})([0-9a-f]{2})([0-9a-f]{2})$/i.exec(colour);
  if (!match) return "#000000";
  const [red = 0, green = 0, blue = 0] = match.slice(1).map((part) => {
    const value = Number.parseInt(part, 16) / 255;
    return value <= 0.04 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue > 0.19 ? "#000000" : "#ffffff";
}

/** Calls `changed` when the page's theme changes. Returns a function that stops it. */
export function watchTheme(changed: () => void): () => void {
  const theme = new MutationObserver(changed);
  theme.observe(document.documentElement, { attributeFilter: ["data-theme"] });
  return () => theme.disconnect();
}
