/** Whether letters that are typed there mean something there: no key of the page is meant. */
export function takesText(place: EventTarget | null): boolean {
  return place instanceof Element && place.matches(textPlaces);
}

const textPlaces =
  "input:not([type=checkbox], [type=radio], [type=range]), select, textarea, [contenteditable=true]";
