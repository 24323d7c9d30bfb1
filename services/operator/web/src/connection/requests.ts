import type { RequestBody } from "../protocol/codec";
import type { Reply } from "../protocol/generated/console_pb";

/** Outcome of a request. */
export type Outcome =
  | { readonly kind: "accepted"; readonly revision: number }
  | { readonly kind: "refused"; readonly reason: string }
  /** It never left the page. */
  | { readonly kind: "not sent"; readonly reason: string }
  /** It left the page, but no reply came: it may have taken effect. */
  | { readonly kind: "unanswered"; readonly reason: string };

export interface PendingRequest {
  readonly id: bigint;
  readonly validUntil: number;
  readonly world: string;
  readonly body: RequestBody;
  sent: boolean;
}

interface Entry extends PendingRequest {
  readonly outcome: Promise<Outcome>;
  settle(outcome: Outcome): void;
}

/** s after expiry in which a reply may still arrive. */
const grace = 1;

/**
 * Requests that wait for their Reply, in order. They keep their ids across connections, so the service executes none twice.
 * Expired ones are never sent.
 */
export class PendingRequests {
  #entries = new Map<bigint, Entry>();
  #newest: bigint;

  /** Ids begin above `idsAbove`. */
  constructor(idsAbove = 0n) {
    this.#newest = idsAbove;
  }

  get size(): number {
    return this.#entries.size;
  }

  /** `validUntil`: wall time of the service. The promise never rejects. */
  add(body: RequestBody, world: string, validUntil: number): [PendingRequest, Promise<Outcome>] {
    this.#newest += 1n;
    let settle: (outcome: Outcome) => void = () => undefined;
    const outcome = new Promise<Outcome>((resolve) => {
      settle = resolve;
    });
    const entry: Entry = {
      id: this.#newest,
      validUntil,
      world,
      body,
      sent: false,
      outcome,
      settle,
    };
    this.#entries.set(entry.id, entry);
    return [entry, outcome];
  }

  /** Once all that wait now are answered or expired. */
  async settled(): Promise<void> {
    await Promise.all([...this.#entries.values()].map(({ outcome }) => outcome));
  }

  answer(reply: Reply): void {
    const entry = this.#entries.get(reply.id);
    if (entry === undefined) return;
    this.#entries.delete(reply.id);
    entry.settle(
      reply.accepted
        ? { kind: "accepted", revision: Number(reply.revision) }
        : { kind: "refused", reason: reply.reason },
    );
  }

  /** `now`: wall time of the service. */
  expire(now: number): void {
    for (const entry of [...this.#entries.values()]) {
      if (now <= entry.validUntil + (entry.sent ? grace : 0)) continue;
      this.#entries.delete(entry.id);
      entry.settle(
        entry.sent
          ? { kind: "unanswered", reason: "no answer in time: check whether it took effect" }
          : { kind: "not sent", reason: "not sent: expired" },
      );
    }
  }

  /** Requests to send, or to send again, over a new connection. */
  toSend(now: number): PendingRequest[] {
    return [...this.#entries.values()].filter(({ validUntil }) => now <= validUntil);
  }

  giveUp(reason: string): void {
    for (const entry of this.#entries.values()) {
      entry.settle({ kind: entry.sent ? "unanswered" : "not sent", reason });
    }
    this.#entries.clear();
  }
}
