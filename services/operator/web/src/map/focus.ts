/** Id of the map's canvas, for the skip link and for keys. */
export const mapId = "map";

/** Focuses the map if nothing has the focus, so that the cursor keys work at once. */
export function focusMapIfNothing(page: Document): void {
  const focused = page.activeElement;
  if (focused !== null && focused !== page.body) return;
  page.getElementById(mapId)?.focus({ preventScroll: true });
}

/** Whether the element takes typed text, so that shortcuts must not react. */
export function takesText(place: EventTarget | null): boolean {
  return place instanceof Element && place.matches(textPlaces);
}

const textPlaces =
  "input:not([type=checkbox], [type=radio], [type=range]), select, textarea, [contenteditable=true]";
