/** Calls `changed` when the page has another theme, and so other colours. Returns what ends it. */
export function watchTheme(changed: () => void): () => void {
  const theme = new MutationObserver(changed);
  theme.observe(document.documentElement, { attributeFilter: ["data-theme"] });
  return () => theme.disconnect();
}
