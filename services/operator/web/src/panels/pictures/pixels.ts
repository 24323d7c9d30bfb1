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

/** Identifies a picture. Sequence numbers restart with each run, and a participant's page sees several runs. */
interface PictureKey {
  readonly run: string;
  readonly robot: string;
  readonly sequence: bigint;
}

interface Entry {
  readonly state: Signal<PixelState>;
  users: number;
}

/** Number of images kept although no component shows them. */
const mostUnused = 32;

/** Images of pictures: fetched once, shared by all components that show them, revoked when unused. */
export class Pixels {
  #parts: PixelParts;
  /** Least recently used first. */
  #entries = new Map<string, Entry>();

  constructor(parts: PixelParts) {
    this.#parts = parts;
  }

  /** Must be followed by one `release`. */
  acquire(picture: PictureKey): ReadonlySignal<PixelState> {
    const known = this.#entries.get(keyOf(picture));
    const entry = known ?? { state: signal<PixelState>({ kind: "loading" }), users: 0 };
    entry.users += 1;
    this.#putLast(picture, entry);
    // A missing image may be available now.
    if (known === undefined || entry.state.value.kind === "missing")
      void this.#load(picture, entry);
    return entry.state;
  }

  release(picture: PictureKey): void {
    const entry = this.#entries.get(keyOf(picture));
    if (entry === undefined) return;
    entry.users = Math.max(0, entry.users - 1);
    this.#putLast(picture, entry);
    this.#forgetOldest();
  }

  #putLast(picture: PictureKey, entry: Entry): void {
    const key = keyOf(picture);
    this.#entries.delete(key);
    this.#entries.set(key, entry);
  }

  async #load(picture: PictureKey, entry: Entry): Promise<void> {
    entry.state.value = { kind: "loading" };
    const { token } = this.#parts;
    const headers: Record<string, string> = token ? { Authorization: `Bearer ${token}` } : {};
    try {
      const reply = await this.#parts.fetch(pathOf(picture), { headers });
      entry.state.value = reply.ok
        ? { kind: "ready", url: this.#parts.createUrl(await reply.blob()) }
        : { kind: "missing", reason: reasonOf(reply.status) };
    } catch {
      entry.state.value = { kind: "missing", reason: "The picture could not be fetched." };
    }
    // The entry was dropped in the meantime.
    if (this.#entries.get(keyOf(picture)) !== entry) this.#revoke(entry);
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

function keyOf(picture: PictureKey): string {
  return `${picture.run} ${pathOf(picture)}`;
}

function pathOf({ robot, sequence }: PictureKey): string {
  return `/pictures/${encodeURIComponent(robot)}/${sequence}.jpg`;
}

function reasonOf(status: number): string {
  if (status === 404) return "This picture is no longer stored.";
  if (status === 401 || status === 403) return "You may not see this picture.";
  return `The service answered with status ${status}.`;
}
