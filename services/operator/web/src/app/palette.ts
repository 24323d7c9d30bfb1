import type { RobotShape } from "../map/map_props";

/** A robot's look everywhere on the page. 16 robots all differ, even without colour. */
interface RobotLook {
  readonly letter: string;
  readonly colour: string;
  readonly shape: RobotShape;
  /** Dash pattern of its lines in CSS pixels; empty = solid. */
  readonly dash: readonly number[];
}

// After Okabe and Ito, adjusted until the contrast to both backgrounds is at least 3 to 1.
const colours = [
  "#d55e00",
  "#0a84c6",
  "#009e73",
  "#c2669c",
  "#a67c00",
  "#7b6fd0",
  "#3d8f9e",
  "#b3564a",
] as const;

const shapes: readonly RobotShape[] = [
  "circle",
  "square",
  "triangle",
  "diamond",
  "pentagon",
  "star",
];
const dashes: readonly (readonly number[])[] = [[], [8, 4], [2, 3], [8, 3, 2, 3]];

/** `index`: position in the configuration. */
export function lookOf(index: number): RobotLook {
  return {
    letter: String.fromCharCode(65 + (index % 26)),
    colour: colours[index % colours.length] ?? colours[0],
    // 6 shapes and 8 colours: a pair repeats after 24 robots.
    shape: shapes[index % shapes.length] ?? "circle",
    dash: dashes[Math.floor(index / 2) % dashes.length] ?? [],
  };
}
