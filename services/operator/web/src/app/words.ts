import { options, type VNode } from "preact";

/** Texts of a participant's page by the English ones. Each "{}" stands for what changes, and is itself looked up. */
export type Words = Readonly<Record<string, string>>;

/** What stands for an English text, blanks around it kept but before a comma; undefined = there is no word for it. */
export function translator(words: Words): (text: string) => string | undefined {
  const patterns = Object.entries(words)
    .filter(([english]) => english.includes("{}"))
    .map(([english, word]) => ({ pattern: patternOf(english), pieces: word.split("{}") }));
  const find = (text: string): string | undefined => {
    if (Object.hasOwn(words, text)) return words[text];
    for (const { pattern, pieces } of patterns) {
      const found = pattern.exec(text);
      if (found === null) continue;
      const gaps = found.slice(1).map((gap) => find(gap) ?? gap);
      return pieces.map((piece, i) => piece + (gaps[i] ?? "")).join("");
    }
    return undefined;
  };
  return (text) => {
    const core = text.trim();
    const word = find(core);
    if (word === undefined) return undefined;
    // "press X, if" where English has "press X if".
    return (/^[,.;:]/.test(word) ? text.trimStart() : text).replace(core, () => word);
  };
}

function patternOf(english: string): RegExp {
  const pieces = english.split("{}").map((piece) => piece.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"));
  return new RegExp(`^${pieces.join("(.+?)")}$`);
}

/** Texts with numbers are without end. */
const mostKnown = 1000;

const attributes = ["alt", "aria-label", "placeholder", "title"];

let say: ((text: string) => string) | undefined;
let current = "{}";

/** From now on the page shows these words. Texts without one stay English, and are named in the browser's console. */
export function setWords(words: Words): void {
  const next = JSON.stringify(words);
  if (next === current) return;
  current = next;
  if (next === "{}") {
    say = undefined;
    return;
  }
  const translate = translator(words);
  const known = new Map<string, string>();
  const said = new Set<string>(); // which come by again where they bypass Preact first
  say = (text) => {
    if (said.has(text)) return text;
    let word = known.get(text);
    if (word === undefined) {
      word = translate(text);
      if (word === undefined && /\p{L}{2}/u.test(text)) console.info(`no words for: ${text}`);
      word ??= text;
      if (known.size === mostKnown) for (const one of [known, said]) one.clear();
      said.add(word);
      known.set(text, word);
    }
    return word;
  };
}

/** For texts that bypass Preact's elements, as signals do. */
export function inWords(text: string): string {
  return say === undefined ? text : say(text);
}

// Preact calls this with each element, and with each text, whose props are the text itself.
const earlier = options.vnode;
options.vnode = (vnode: VNode) => {
  if (say !== undefined) translate(vnode as { type: unknown; props: unknown }, say);
  earlier?.(vnode);
};

function translate(vnode: { type: unknown; props: unknown }, word: (text: string) => string): void {
  if (vnode.type === null && typeof vnode.props === "string") vnode.props = word(vnode.props);
  if (typeof vnode.type !== "string") return;
  const props = vnode.props as Record<string, unknown>;
  for (const name of attributes) {
    const text = props[name];
    if (typeof text === "string" && text !== "") props[name] = word(text);
  }
}
