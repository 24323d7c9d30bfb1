import { describe, expect, it } from "vitest";
import { type BrowserEnvironment, identify, rememberName } from "./identity";

function browser(hash: string, stored: Record<string, string> = {}) {
  const session = new Map(Object.entries(stored));
  const addresses: string[] = [];
  const environment: BrowserEnvironment = {
    location: { hash, pathname: "/", search: "?x=1" },
    history: { replaceState: (_data, _unused, url) => addresses.push(url) },
    sessionStorage: {
      getItem: (key) => session.get(key) ?? null,
      setItem: (key, value) => session.set(key, value),
    },
    localStorage: { getItem: () => null, setItem: () => undefined },
    reloaded: false,
    now: 1000,
    crypto: { getRandomValues: (array) => array.fill(171) },
  };
  return { environment, session, addresses };
}

describe("identify", () => {
  it("is an experimenter's by the address", () => {
    const { environment } = browser("");
    expect(identify(environment).experimenter).toBe(false);
    const leads = { ...environment.location, search: "?experimenter" };
    expect(identify({ ...environment, location: leads }).experimenter).toBe(true);
  });

  it("moves the token from the address to the session", () => {
    const { environment, session, addresses } = browser("#token=a%20b&layer=seen");
    expect(identify(environment).token).toBe("a b");
    expect(session.get("conav.token")).toBe("a b");
    expect(addresses).toEqual(["/?x=1#layer=seen"]);
  });

  it("finds the token again after a reload", () => {
    expect(identify(browser("", { "conav.token": "kept" }).environment).token).toBe("kept");
  });

  it("leaves an address without a token alone", () => {
    const { environment, addresses } = browser("#layer=seen");
    expect(identify(environment).token).toBe("");
    expect(addresses).toEqual([]);
  });

  it("stays the same instance when it is reloaded, and asks with higher ids", () => {
    const stored = { "conav.instance": "0123456789abcdef" };
    const { environment } = browser("", stored);
    const again = identify({ ...environment, reloaded: true, now: 1001 });
    expect(again.instance).toBe("0123456789abcdef");
    expect(again.idsAbove).toBeGreaterThan(identify(environment).idsAbove);
  });

  it("is another instance in a tab that was duplicated", () => {
    const stored = { "conav.instance": "0123456789abcdef" };
    const { environment, session } = browser("", stored);
    const { instance } = identify(environment);
    expect(instance).not.toBe("0123456789abcdef");
    expect(session.get("conav.instance")).toBe(instance);
  });

  it("makes an instance that the service accepts, and has a name", () => {
    const { instance, name, isNamed } = identify(browser("").environment);
    expect(instance).toMatch(/^[0-9a-z-]{16,64}$/);
    expect([name, isNamed]).toEqual(["Guest", false]);
  });

  it("has the name that the person gave, without what the service refuses", () => {
    const kept = new Map<string, string>();
    const localStorage = {
      getItem: (key: string) => kept.get(key) ?? null,
      setItem: (key: string, value: string) => void kept.set(key, value),
    };
    const { environment } = browser("");
    expect(rememberName({ localStorage }, " Ann/e\n ")).toBe("Ann e");
    expect(identify({ ...environment, localStorage })).toMatchObject({
      name: "Ann e",
      isNamed: true,
    });
  });
});
