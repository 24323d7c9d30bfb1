import { type ReadonlySignal, type Signal, signal } from "@preact/signals";

export type PixelState =
  | { readonly kind: "loading" }
  | { readonly kind: "ready"; readonly url: string }
  | { readonly kind: "missing"; readonly reason: string };

interface PixelParts {
  readonly token: string;
  fetch(path: string, init: { headers: Record<string, string> }): Promise<PixelReply>;
  /** As URL.createObjectURL and revokeObjectURL. */
  createUrl(blob: Blob): string;
  revokeUrl(url: string): void;
}

export interface PixelReply {
  readonly ok: boolean;
  readonly status: number;
  blob(): Promise<Blob>;
}

/** Which picture. Numbers begin anew with each run, and one page may see several: the mazes of a participant. */
interface PictureKey {
  readonly run: string;
  readonly robot: string;
  readonly sequence: bigint;
}

interface Entry {
  readonly state: Signal<PixelState>;
  users: number;
}

/** So many pictures that nobody shows are kept, for whoever turns pages. */
const mostUnused = 32;

/** The pixels of pictures: fetched once, shared by whoever shows them, given back when unused. */
export class Pixels {
  #parts: PixelParts;
  /** The one that was used last comes last. */
  #entries = new Map<string, Entry>();

  constructor(parts: PixelParts) {
    this.#parts = parts;
  }

  /** To be followed by one `release`. */
  acquire(shot: PictureKey): ReadonlySignal<PixelState> {
    const known = this.#entries.get(keyOf(shot));
    const entry = known ?? { state: signal<PixelState>({ kind: "loading" }), users: 0 };
    entry.users += 1;
    this.#putLast(shot, entry);
    // What was missing may be there now.
    if (known === undefined || entry.state.value.kind === "missing") void this.#load(shot, entry);
    return entry.state;
  }

  release(shot: PictureKey): void {
    const entry = this.#entries.get(keyOf(shot));
    if (entry === undefined) return;
    entry.users = Math.max(0, entry.users - 1);
    this.#putLast(shot, entry);
    this.#forgetOldest();
  }

  #putLast(shot: PictureKey, entry: Entry): void {
    const key = keyOf(shot);
    this.#entries.delete(key);
    this.#entries.set(key, entry);
  }

  async #load(shot: PictureKey, entry: Entry): Promise<void> {
    entry.state.value = { kind: "loading" };
    const { token } = this.#parts;
    const headers: Record<string, string> = token ? { Authorization: `Bearer ${token}` } : {};
    try {
      const reply = await this.#parts.fetch(pathOf(shot), { headers });
      entry.state.value = reply.ok
        ? { kind: "ready", url: this.#parts.createUrl(await reply.blob()) }
        : { kind: "missing", reason: reasonOf(reply.status) };
    } catch {
      entry.state.value = { kind: "missing", reason: "The picture could not be fetched." };
    }
    // It was forgotten meanwhile.
    if (this.#entries.get(keyOf(shot)) !== entry) this.#revoke(entry);
  }

  #forgetOldest(): void {
    const unused = [...this.#entries].filter(([, { users }]) => users === 0);
    for (const [key, entry] of unused.slice(0, Math.max(0, unused.length - mostUnused))) {
      this.#entries.delete(key);
      this.#revoke(entry);
    }
  }

  #revoke({ state }: Entry): void {
    if (state.value.kind === "ready") this.#parts.revokeUrl(state.value.url);
  }
}

function keyOf(shot: PictureKey): string {
  return `${shot.run} ${pathOf(shot)}`;
}

function pathOf({ robot, sequence }: PictureKey): string {
  return `/pictures/${encodeURIComponent(robot)}/${sequence}.jpg`;
}

function reasonOf(status: number): string {
  if (status === 404) return "The service keeps these pixels no more.";
  if (status === 401 || status === 403) return "The service refuses to show this picture.";
  return `The service answers with ${status}.`;
}
