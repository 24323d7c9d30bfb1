import { describe, expect, it } from "vitest";
import { storageOf, type TextStorage } from "./browser_storage";

function kept(texts = new Map<string, string>()): TextStorage {
  return {
    getItem: (key) => texts.get(key) ?? null,
    setItem: (key, value) => void texts.set(key, value),
  };
}

const full: TextStorage = {
  ...kept(new Map([["a", "old"]])),
  setItem: () => {
    throw new Error("full");
  },
};

describe("storage", () => {
  it("is the browser's", () => {
    const texts = new Map<string, string>();
    storageOf(() => kept(texts)).setItem("a", "1");
    expect(texts.get("a")).toBe("1");
    expect(storageOf(() => kept(texts)).getItem("a")).toBe("1");
  });

  it("has nothing where nothing was kept", () => {
    expect(storageOf(() => kept()).getItem("a")).toBeNull();
  });

  it("that is full keeps the newest as long as the page", () => {
    const storage = storageOf(() => full);
    storage.setItem("a", "new");
    expect(storage.getItem("a")).toBe("new");
  });

  it("that is forbidden, even to look at, does the same", () => {
    const storage = storageOf(() => {
      throw new Error("forbidden");
    });
    expect(storage.getItem("a")).toBeNull();
    storage.setItem("a", "1");
    expect(storage.getItem("a")).toBe("1");
  });
});
