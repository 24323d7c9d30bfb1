import type { Tool } from "./map_props";

/** Shows what robots saw: not for participants. */
export const solidKey = "3";

/** The map's keys, for the help. */
export const mapShortcuts: readonly { readonly keys: readonly string[]; readonly text: string }[] =
  [
    { keys: ["V"], text: "Look around: drag to pan, click to choose a robot" },
    { keys: ["W"], text: "Draw walls" },
    { keys: ["E"], text: "Erase walls" },
    { keys: ["R"], text: "Draw a rectangle of walls; with Shift erase" },
    { keys: ["P"], text: "Draw a path from a robot; drag its cells to bend it, its end to go on" },
    { keys: ["O"], text: "Set and remove the chosen robot's goals" },
    { keys: ["Ctrl+Z"], text: "Undo the last map edit; with the tool Goals the last goal" },
    { keys: ["Ctrl+Y", "Ctrl+Shift+Z"], text: "Redo" },
    { keys: ["+"], text: "Zoom in" },
    { keys: ["-"], text: "Zoom out" },
    { keys: ["0"], text: "Show the whole map" },
    { keys: ["L"], text: "Choose layers" },
    { keys: [solidKey], text: "Show the world in three dimensions, to look at" },
    { keys: ["Arrow keys"], text: "Move the cell cursor (focus on the map)" },
    {
      keys: ["Home", "End"],
      text: "Cursor to the first or last cell of the row; with Ctrl of the map",
    },
    { keys: ["Shift+Arrow keys"], text: "Pan the map" },
    { keys: ["Space"], text: "Use the tool at the cursor; hold while dragging to pan" },
    { keys: ["Enter"], text: "Use the tool at the cursor; send the path if one is drawn" },
    { keys: ["Delete"], text: "Remove the path's corner at the cursor, or its end" },
    { keys: ["Esc"], text: "Cancel the drawing" },
  ];

/** The keys that apply; for the parameters see MapProps. */
export function shortcutsWith(
  offersPaths: boolean,
  arrowsDrive: boolean,
  offersGoals: boolean,
): typeof mapShortcuts {
  const offered = mapShortcuts.filter(
    ({ keys: [key = ""] }) =>
      (offersPaths || !pathKeys.has(key)) && (offersGoals || key !== goalKey),
  );
  const cursor = "With the tools W, E and R: move the cell cursor";
  return offered.map((shortcut) =>
    arrowsDrive && shortcut.keys[0] === "Arrow keys" ? { ...shortcut, text: cursor } : shortcut,
  );
}

const goalKey = "O";
/** Keys of the path tool. */
const pathKeys: ReadonlySet<string> = new Set(["P", "Delete"]);

export const toolKeys: ReadonlyMap<string, Tool> = new Map([
  ["v", "look"],
  ["w", "wall"],
  ["e", "erase"],
  ["r", "rectangle"],
  ["p", "path"],
  ["o", "goal"],
]);
