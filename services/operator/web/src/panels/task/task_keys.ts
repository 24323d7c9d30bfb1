import type { CommandName } from "../../app/shortcuts";

/** Keys that a participant of the mapping task has, beside those of the map. */
export const taskKeys: readonly { readonly keys: readonly string[]; readonly text: string }[] = [
  { keys: ["n", "x"], text: "Next picture" },
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

/** What a key means in the mapping task: N is the next picture there; undefined = nothing. */
export function inMappingTask(command: CommandName | undefined): CommandName | undefined {
  if (command === "next") return "nothing new";
  return command !== undefined && allowed.has(command) ? command : undefined;
}
