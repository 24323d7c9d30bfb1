/** Texts that the browser keeps between two loads of the page. */
export type TextStorage = Pick<Storage, "getItem" | "setItem">;

/** The storage that `find` returns. Values that it refuses, because it is full or forbidden, live as long as the page. */
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
