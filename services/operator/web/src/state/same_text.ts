import { computed, type ReadonlySignal } from "@preact/signals";

/** Of a plain small value: changes only when what it tells does, not whenever it is worked out anew. */
export function sameText<T>(source: () => T): ReadonlySignal<T> {
  let kept: { readonly value: T; readonly text: string } | undefined;
  return computed(() => {
    const value = source();
    const text = JSON.stringify(value);
    if (kept?.text !== text) kept = { value, text };
    return kept.value;
  });
}
