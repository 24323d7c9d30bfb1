/** Keys of the map, for the help; the map handles them while it has the focus. Stands in until the map is there. */
export const mapKeys: readonly { readonly keys: readonly string[]; readonly text: string }[] = [];
