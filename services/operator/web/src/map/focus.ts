/** Of the map's canvas, for the skip link and for keys. */
export const mapId = "map";

/** Gives the map the focus where nothing has it: then the keys of its cursor work at once. */
export function focusMapIfNothing(page: Document): void {
  const focused = page.activeElement;
  if (focused !== null && focused !== page.body) return;
  page.getElementById(mapId)?.focus({ preventScroll: true });
}

/** Whether letters that are typed there mean something there: no key of the page is meant. */
export function takesText(place: EventTarget | null): boolean {
  return place instanceof Element && place.matches(textPlaces);
}

const textPlaces =
  "input:not([type=checkbox], [type=radio], [type=range]), select, textarea, [contenteditable=true]";
