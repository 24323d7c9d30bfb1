import type { Tool } from "./map_props";

/** What the map's keys do, for the page's help. */
export const mapShortcuts: readonly { readonly keys: readonly string[]; readonly text: string }[] =
  [
    { keys: ["V"], text: "Look around: drag pans, a click chooses a robot" },
    { keys: ["W"], text: "Draw walls" },
    { keys: ["E"], text: "Erase walls" },
    { keys: ["R"], text: "Rectangle of walls; with Shift erase it" },
    { keys: ["P"], text: "Draw the chosen robot's path" },
    { keys: ["Ctrl+Z"], text: "Undo the last edit of the map" },
    { keys: ["Ctrl+Y", "Ctrl+Shift+Z"], text: "Redo it" },
    { keys: ["+"], text: "Zoom in" },
    { keys: ["-"], text: "Zoom out" },
    { keys: ["0"], text: "Show all of the map" },
    { keys: ["L"], text: "Choose the layers" },
    { keys: ["Arrow keys"], text: "Move the cell cursor, with the focus on the map" },
    { keys: ["Home", "End"], text: "Cursor to the row's first or last cell; with Ctrl the map's" },
    { keys: ["Shift+Arrow keys"], text: "Move the map" },
    { keys: ["Space"], text: "Use the tool at the cursor; held while dragging: move the map" },
    { keys: ["Enter"], text: "Use the tool at the cursor; with a path drawn: send it" },
    { keys: ["Delete"], text: "Remove the path's corner at the cursor, or its end" },
    { keys: ["Esc"], text: "Leave what is being drawn" },
  ];

/** As `offersPaths` and `arrowsDrive` of MapProps. */
export function shortcutsWith(offersPaths: boolean, arrowsDrive: boolean): typeof mapShortcuts {
  const offered = mapShortcuts.filter(({ keys }) => offersPaths || !pathKeys.has(keys[0] ?? ""));
  const cursor = "With the tools W, E and R: move the cell cursor on the map";
  return offered.map((shortcut) =>
    arrowsDrive && shortcut.keys[0] === "Arrow keys" ? { ...shortcut, text: cursor } : shortcut,
  );
}

/** Of the path tool. */
const pathKeys: ReadonlySet<string> = new Set(["P", "Delete"]);

export const toolKeys: ReadonlyMap<string, Tool> = new Map([
  ["v", "look"],
  ["w", "wall"],
  ["e", "erase"],
  ["r", "rectangle"],
  ["p", "path"],
]);
