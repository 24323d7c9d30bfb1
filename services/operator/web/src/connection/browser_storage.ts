/** What is kept in a browser between two loads of the page. */
export type TextStorage = Pick<Storage, "getItem" | "setItem">;

/** The browser's storage that `find` finds; what it refuses to keep, because it is full or forbidden, is kept as long as the page. */
export function storageOf(find: () => TextStorage): TextStorage {
  const refused = new Map<string, string>();
  return {
    getItem: (key) => refused.get(key) ?? attempt(() => find().getItem(key)) ?? null,
    setItem: (key, value) => {
      const done = attempt(() => {
        find().setItem(key, value);
        return true;
      });
      if (done) refused.delete(key);
      else refused.set(key, value);
    },
  };
}

function attempt<T>(act: () => T): T | undefined {
  try {
    return act();
  } catch {
    return undefined;
  }
}
