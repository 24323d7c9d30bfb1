/** Calls `changed` when colours may have: another theme of the page or of the system. Returns what ends it. */
export function watchTheme(changed: () => void): () => void {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  dark.addEventListener("change", changed);
  const attributes = new MutationObserver(changed);
  attributes.observe(document.documentElement, {
    attributes: true,
    attributeFilter: ["data-theme", "class", "style"],
  });
  return () => {
    dark.removeEventListener("change", changed);
    attributes.disconnect();
  };
}
