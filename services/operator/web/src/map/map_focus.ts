/** Of the map's canvas, for the skip link and for keys. */
export const mapId = "map";

/** Gives the map the focus where nothing has it: then the keys of its cursor work at once. */
export function focusMapIfNothing(page: Document): void {
  const focused = page.activeElement;
  if (focused !== null && focused !== page.body) return;
  page.getElementById(mapId)?.focus({ preventScroll: true });
}
