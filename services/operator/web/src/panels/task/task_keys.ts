import type { CommandName } from "../../app/shortcuts";
import type { ConsoleState } from "../../state/console_state";
import {
  hasSeveralRobots,
  isExperimenter,
  isMappingTask,
  isMaze,
  isStudy,
  isTask,
} from "./task_state";

interface Key {
  readonly keys: readonly string[];
  readonly text: string;
}

/** Key to answer a picture: in the mapping task, and in a study. */
export const nextPictureKey: Key = { keys: ["n", "x"], text: "Next picture" };
export const nothingNewKey: Key = { keys: ["x"], text: "Nothing new in this picture" };

/** Not in studies: it would widen or narrow the pupils. */
export const themeKey = "d";

/** A participant's other keys, except those of the map. */
export const taskKeys: readonly Key[] = [
  { keys: ["["], text: "Older picture" },
  { keys: ["]"], text: "Newer picture" },
  { keys: ["c"], text: "Centre the map on the robot" },
  { keys: ["s"], text: "Stop the robot" },
  { keys: ["g"], text: "Resume the robot" },
  { keys: [themeKey], text: "Switch theme: dark, light, system" },
  { keys: ["?"], text: "Show this help" },
];

/** Likewise, where there is more than one robot. */
export const robotKeys: readonly Key[] = [
  { keys: ["n"], text: "Go to the next robot that needs you" },
  { keys: ["j"], text: "Next robot" },
  { keys: ["k"], text: "Previous robot" },
];

const forSeveral: ReadonlySet<CommandName> = new Set(["next", "next robot", "previous robot"]);

const allowed: ReadonlySet<CommandName> = new Set([
  "nothing new",
  "older picture",
  "newer picture",
  "centre",
  "stop all",
  "stop robot",
  "resume robot",
  "resume all",
  "theme",
  "help",
]);

/** The command that a key means on this page; undefined = none. In the mapping task N asks for the next picture. */
export function inTask(
  state: ConsoleState,
  command: CommandName | undefined,
): CommandName | undefined {
  if (!isTask(state)) return command;
  const { task } = state;
  if (isExperimenter(state) || (task !== undefined && (!isMaze(task) || task.paused))) {
    return command === "stop all" ? command : undefined;
  }
  if (command === "theme" && isStudy(state)) return undefined;
  if (command === "next" && isMappingTask(state)) return "nothing new";
  const has = (commands: ReadonlySet<CommandName>) =>
    command !== undefined && commands.has(command);
  return has(allowed) || (hasSeveralRobots(state) && has(forSeveral)) ? command : undefined;
}
