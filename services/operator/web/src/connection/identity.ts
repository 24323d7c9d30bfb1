/** Who this page says it is, see Hello. */
export interface Identity {
  readonly token: string;
  readonly name: string;
  readonly instance: string;
}

/** What is read and written of the browser. */
export interface Surroundings {
  readonly location: { readonly hash: string; readonly pathname: string; readonly search: string };
  readonly history: { replaceState(data: unknown, unused: string, url: string): void };
  readonly sessionStorage: Pick<Storage, "getItem" | "setItem">;
  readonly localStorage: Pick<Storage, "getItem" | "setItem">;
  readonly crypto: { getRandomValues(array: Uint8Array<ArrayBuffer>): unknown };
}

const tokenKey = "conav.token";
const nameKey = "conav.name";
const longestName = 40;

export function identify(browser: Surroundings): Identity {
  return {
    token: takeToken(browser),
    name: (browser.localStorage.getItem(nameKey) ?? "").trim().slice(0, longestName) || "operator",
    instance: makeInstance(browser.crypto),
  };
}

export function rememberName(browser: Surroundings, name: string): void {
  browser.localStorage.setItem(nameKey, name.trim().slice(0, longestName));
}

/** `#token=...` of the address counts, and leaves it: addresses get copied, and shown to others. */
function takeToken({ location, history, sessionStorage }: Surroundings): string {
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

function makeInstance(crypto: Surroundings["crypto"]): string {
  const bytes = new Uint8Array(16);
  crypto.getRandomValues(bytes);
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}
