import { storageOf, type TextStorage } from "./browser_storage";

/** Identity of this page in Hello. */
export interface Identity {
  readonly token: string;
  /** As others see it. */
  readonly name: string;
  /** Whether the person has given that name. */
  readonly isNamed: boolean;
  readonly instance: string;
  /** Whether the page is opened for the experimenter of a study: `?experimenter`. */
  readonly experimenter: boolean;
  /** Request ids are above this, and so above those used before a reload. */
  readonly idsAbove: bigint;
}

/** The parts of the browser that this module uses. */
export interface BrowserEnvironment {
  readonly location: { readonly hash: string; readonly pathname: string; readonly search: string };
  readonly history: { replaceState(data: unknown, unused: string, url: string): void };
  readonly sessionStorage: TextStorage;
  readonly localStorage: TextStorage;
  /** Whether the page was reloaded in its tab, rather than opened. */
  readonly reloaded: boolean;
  /** s since 1970. */
  readonly now: number;
  readonly crypto: { getRandomValues(array: Uint8Array<ArrayBuffer>): unknown };
}

const tokenKey = "conav.token";
const instanceKey = "conav.instance";
const nameKey = "conav.name";
const longestName = 40;

/** Of a person who has not given a name. */
const anyName = "Guest";

export function identify(browser: BrowserEnvironment): Identity {
  const name = cleaned(browser.localStorage.getItem(nameKey) ?? "");
  return {
    token: takeToken(browser),
    name: name || anyName,
    isNamed: name !== "",
    instance: takeInstance(browser),
    experimenter: new URLSearchParams(browser.location.search).has("experimenter"),
    idsAbove: BigInt(Math.round(browser.now * 1e6)),
  };
}

/** Keeps the name for later visits; returns it as others will see it. */
export function rememberName(
  browser: Pick<BrowserEnvironment, "localStorage">,
  name: string,
): string {
  browser.localStorage.setItem(nameKey, cleaned(name));
  return cleaned(name) || anyName;
}

/** The service accepts no slash and no control characters. */
function cleaned(name: string): string {
  return name
    .replace(/[/\p{Cc}]/gu, " ")
    .trim()
    .slice(0, longestName);
}

/** Takes `#token=...` out of the address, because people copy and show addresses. */
function takeToken({ location, history, sessionStorage }: BrowserEnvironment): string {
  const parts = location.hash.replace(/^#/, "").split("&");
  const given = parts.find((part) => part.startsWith("token="));
  if (given === undefined) return sessionStorage.getItem(tokenKey) ?? "";
  const token = decodeToken(given.slice("token=".length));
  sessionStorage.setItem(tokenKey, token);
  const rest = parts.filter((part) => part !== given).join("&");
  history.replaceState(undefined, "", location.pathname + location.search + (rest && `#${rest}`));
  return token;
}

function decodeToken(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/**
 * A reloaded page keeps its instance, and with it the control of robots. A duplicated tab shares the session storage but gets
 * a new instance.
 */
function takeInstance(browser: BrowserEnvironment): string {
  const kept = browser.reloaded ? browser.sessionStorage.getItem(instanceKey) : null;
  const instance = kept ?? makeInstance(browser.crypto);
  browser.sessionStorage.setItem(instanceKey, instance);
  return instance;
}

/** The real browser. */
export function browserEnvironment(window: Window & typeof globalThis): BrowserEnvironment {
  const [entry] = window.performance.getEntriesByType("navigation");
  const reloaded = entry instanceof PerformanceNavigationTiming && entry.type === "reload";
  const { location, history, crypto } = window;
  return {
    location,
    history,
    sessionStorage: storageOf(() => window.sessionStorage),
    localStorage: storageOf(() => window.localStorage),
    crypto,
    reloaded,
    now: Date.now() / 1000,
  };
}

function makeInstance(crypto: BrowserEnvironment["crypto"]): string {
  const bytes = new Uint8Array(16);
  crypto.getRandomValues(bytes);
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}
