import type { CommandName } from "../../app/shortcuts";
import type { ConsoleState } from "../../state/console_state";
import { isMappingTask, isTask } from "./task_state";

interface Key {
  readonly keys: readonly string[];
  readonly text: string;
}

/** The key by which a participant answers a picture. */
export const nextPictureKey: Key = { keys: ["n", "x"], text: "Next picture" };
export const nothingNewKey: Key = { keys: ["x"], text: "Nothing new in this picture" };

/** Keys that a participant has besides, and beside those of the map. */
export const taskKeys: readonly Key[] = [
  { keys: ["["], text: "Look at an older picture" },
  { keys: ["]"], text: "Look at a newer picture" },
  { keys: ["c"], text: "Centre the map on the robot" },
  { keys: ["s"], text: "Stop the robot" },
  { keys: ["g"], text: "Let it go on" },
  { keys: ["d"], text: "Dark, light, or as the system" },
  { keys: ["?"], text: "Show this help" },
];

const allowed: ReadonlySet<CommandName> = new Set([
  "nothing new",
  "older picture",
  "newer picture",
  "centre",
  "stop all",
  "stop robot",
  "go robot",
  "go all",
  "theme",
  "help",
]);

/** What a key means for whoever sits here; undefined = nothing. In the mapping task N is the next picture. */
export function inTask(
  state: ConsoleState,
  command: CommandName | undefined,
): CommandName | undefined {
  if (!isTask(state)) return command;
  if (command === "next" && isMappingTask(state)) return "nothing new";
  return command !== undefined && allowed.has(command) ? command : undefined;
}
