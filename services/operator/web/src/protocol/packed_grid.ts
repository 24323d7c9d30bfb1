// Grids as idl/console.proto packs them.

/** More cells than any service sends, so that a damaged message cannot take all memory. */
const mostCells = 2 ** 26;

/** The cells of a packed grid, row-major; none if it is empty. Throws if it is damaged. */
export function unpackGrid(packed: Uint8Array): Uint8Array<ArrayBuffer> {
  if (packed.length === 0) return new Uint8Array();
  let cells = new Uint8Array();
  // Once for the number of cells, and once for the cells.
  for (const filling of [false, true]) {
    const reader = new Reader(packed);
    const columns = Math.max(1, reader.varint());
    let at = 0;
    while (!reader.atEnd) {
      const end = at + reader.varint();
      const difference = reader.byte();
      if (end > mostCells) throw new RangeError(`a grid of more than ${mostCells} cells`);
      if (filling) fill(cells, columns, at, end, difference);
      at = end;
    }
    if (!filling) cells = new Uint8Array(at);
  }
  return cells;
}

/** Row by row, because each follows from the one to its north. */
function fill(cells: Uint8Array, columns: number, at: number, end: number, difference: number) {
  for (let begin = at; begin < end; begin += columns) {
    const stop = Math.min(end, begin + columns);
    const second = Math.max(begin, columns); // the first row has none to its north
    if (second < stop) cells.copyWithin(second, second - columns, stop - columns);
    if (difference === 0) continue;
    for (let i = begin; i < stop; ++i) cells[i] = (cells[i] ?? 0) ^ difference;
  }
}

class Reader {
  readonly #bytes: Uint8Array;
  #at = 0;

  constructor(bytes: Uint8Array) {
    this.#bytes = bytes;
  }

  get atEnd(): boolean {
    return this.#at >= this.#bytes.length;
  }

  byte(): number {
    const byte = this.#bytes[this.#at];
    if (byte === undefined) throw new RangeError("a grid that is cut off");
    this.#at += 1;
    return byte;
  }

  varint(): number {
    let number = 0;
    for (let place = 1; ; place *= 128) {
      const byte = this.byte();
      number += place * (byte & 127);
      if (byte < 128) return number;
    }
  }
}
