/** Commands that have a key. */
export type CommandName =
  | "stop all"
  | "stop robot"
  | "resume robot"
  | "resume all"
  | "take control"
  | "release control"
  | "next"
  | "nothing new"
  | "older picture"
  | "newer picture"
  | "next robot"
  | "previous robot"
  | "centre"
  | "acknowledge"
  | "workload"
  | "events"
  | "fleet"
  | "camera"
  | "note"
  | "close view"
  | "theme"
  | "help"
  | "play"
  | "mark before"
  | "mark after";

export type Commands = Readonly<Record<CommandName, () => void>>;

export type Group = "Safety" | "Attention" | "Robots" | "Page" | "Recording" | "Driving";

interface Shortcut {
  readonly command: CommandName;
  /** Any of these keys, written as by `keyOf`. */
  readonly keys: readonly string[];
  readonly text: string;
  readonly group: Group;
  /** Works also while somebody types or a dialog is open. */
  readonly always?: true;
  /** Only in recordings. All other keys work there, too. */
  readonly replay?: true;
}

/** All shortcuts: the key handler and the help dialog read this table. */
export const shortcuts: readonly Shortcut[] = [
  {
    command: "stop all",
    keys: ["Shift+Escape"],
    text: "Stop all robots",
    group: "Safety",
    always: true,
  },
  { command: "stop robot", keys: ["s", "."], text: "Stop the chosen robot", group: "Safety" },
  { command: "resume robot", keys: ["g"], text: "Resume the chosen robot", group: "Safety" },
  { command: "resume all", keys: ["Shift+g"], text: "Resume all robots", group: "Safety" },
  {
    command: "take control",
    keys: ["t"],
    text: "Take control of the chosen robot",
    group: "Safety",
  },
  { command: "release control", keys: ["Shift+t"], text: "Release control", group: "Safety" },
  { command: "acknowledge", keys: ["a"], text: "Acknowledge the worst alert", group: "Safety" },
  { command: "next", keys: ["n"], text: "Go to the next item that needs you", group: "Attention" },
  {
    command: "nothing new",
    keys: ["x"],
    text: "Answer: nothing new in this picture",
    group: "Attention",
  },
  { command: "older picture", keys: ["["], text: "Older picture", group: "Attention" },
  { command: "newer picture", keys: ["]"], text: "Newer picture", group: "Attention" },
  { command: "next robot", keys: ["j"], text: "Next robot", group: "Robots" },
  { command: "previous robot", keys: ["k"], text: "Previous robot", group: "Robots" },
  { command: "centre", keys: ["c"], text: "Centre the map on the chosen robot", group: "Robots" },
  { command: "camera", keys: ["i"], text: "Open or close the robot's camera", group: "Robots" },
  { command: "fleet", keys: ["f"], text: "Show all robots as a list", group: "Robots" },
  { command: "note", keys: ["m"], text: "Write a note about this moment", group: "Page" },
  { command: "close view", keys: ["Escape"], text: "Close the large view", group: "Page" },
  { command: "workload", keys: ["u"], text: "Show your workload", group: "Page" },
  { command: "events", keys: ["q"], text: "Show the command log", group: "Page" },
  { command: "theme", keys: ["d"], text: "Switch theme: dark, light, system", group: "Page" },
  { command: "help", keys: ["?", "F1"], text: "Show this help", group: "Page" },
  { command: "play", keys: ["Space"], text: "Play or pause", group: "Recording", replay: true },
  {
    command: "mark before",
    keys: ["PageUp"],
    text: "Go to the previous mark",
    group: "Recording",
    replay: true,
  },
  {
    command: "mark after",
    keys: ["PageDown"],
    text: "Go to the next mark",
    group: "Recording",
    replay: true,
  },
];

/** Keys to hold for driving by hand (see Teleoperation), for the help. */
export const driveHelp = [
  { keys: ["ArrowUp"], text: "Drive forward while held" },
  { keys: ["ArrowDown"], text: "Drive backward while held" },
  { keys: ["ArrowLeft"], text: "Turn left while held" },
  { keys: ["ArrowRight"], text: "Turn right while held" },
] as const;

interface KeyPress {
  readonly key: string;
  readonly shiftKey: boolean;
  readonly ctrlKey: boolean;
  readonly altKey: boolean;
  readonly metaKey: boolean;
}

/** "n", "Shift+n", "Shift+Escape", "?", ... Punctuation omits Shift, because keyboards differ there. */
export function keyOf({ key, shiftKey, ctrlKey, altKey, metaKey }: KeyPress): string | undefined {
  if (ctrlKey || altKey || metaKey) return undefined;
  if (key === " ") return "Space";
  const name = key.length === 1 ? key.toLowerCase() : key;
  const isSign = key.length === 1 && key.toLowerCase() === key.toUpperCase();
  return shiftKey && !isSign ? `Shift+${name}` : name;
}

interface KeyContext {
  readonly replay: boolean;
  /** Somebody types, or a dialog is open. */
  readonly busy: boolean;
  /** The focus is on an element that uses Space itself. */
  readonly onControl: boolean;
}

export function commandOf(press: KeyPress, at: KeyContext): CommandName | undefined {
  const key = keyOf(press);
  const found = shortcuts.find(({ keys }) => key !== undefined && keys.includes(key));
  if (found === undefined) return undefined;
  if (at.busy && !found.always) return undefined;
  if (found.replay && !at.replay) return undefined;
  if (at.onControl && key === "Space") return undefined;
  return found.command;
}

const keyNames: Readonly<Record<string, string>> = {
  Escape: "Esc",
  ArrowUp: "↑",
  ArrowDown: "↓",
  ArrowLeft: "←",
  ArrowRight: "→",
};

/** A key as people read it: ["Shift", "Esc"]. */
export function keyParts(key: string): readonly string[] {
  // The last part may be "+" itself.
  return key
    .split(/\+(?=.)/)
    .map((part) => keyNames[part] ?? (part.length === 1 ? part.toUpperCase() : part));
}

/** The first key of a command, for buttons: "Shift Esc". */
export function keyHint(command: CommandName): string {
  const key = shortcuts.find((shortcut) => shortcut.command === command)?.keys[0] ?? "";
  return keyParts(key).join(" ");
}
