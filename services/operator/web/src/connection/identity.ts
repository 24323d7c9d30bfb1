import { storageOf, type TextStorage } from "./browser_storage";

/** Who this page says it is, see Hello. */
export interface Identity {
  readonly token: string;
  readonly name: string;
  readonly instance: string;
  /** Ids of requests are above it: also above those of the same instance before a reload. */
  readonly idsAbove: bigint;
}

/** What is read and written of the browser. */
export interface BrowserEnvironment {
  readonly location: { readonly hash: string; readonly pathname: string; readonly search: string };
  readonly history: { replaceState(data: unknown, unused: string, url: string): void };
  readonly sessionStorage: TextStorage;
  readonly localStorage: TextStorage;
  /** Whether the page was loaded anew in its tab, rather than opened. */
  readonly reloaded: boolean;
  /** s since 1970. */
  readonly now: number;
  readonly crypto: { getRandomValues(array: Uint8Array<ArrayBuffer>): unknown };
}

const tokenKey = "conav.token";
const instanceKey = "conav.instance";
const nameKey = "conav.name";
const longestName = 40;

export function identify(browser: BrowserEnvironment): Identity {
  return {
    token: takeToken(browser),
    name: (browser.localStorage.getItem(nameKey) ?? "").trim().slice(0, longestName) || "operator",
    instance: takeInstance(browser),
    idsAbove: BigInt(Math.round(browser.now * 1e6)),
  };
}

export function rememberName(
  browser: Pick<BrowserEnvironment, "localStorage">,
  name: string,
): void {
  browser.localStorage.setItem(nameKey, name.trim().slice(0, longestName));
}

/** `#token=...` of the address counts, and leaves it: addresses get copied, and shown to others. */
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
 * A page that is reloaded stays who it was, and keeps its control of robots. A tab that was duplicated has the same
 * session, but is another page.
 */
function takeInstance(browser: BrowserEnvironment): string {
  const kept = browser.reloaded ? browser.sessionStorage.getItem(instanceKey) : null;
  const instance = kept ?? makeInstance(browser.crypto);
  browser.sessionStorage.setItem(instanceKey, instance);
  return instance;
}

/** The browser's own surroundings. */
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
