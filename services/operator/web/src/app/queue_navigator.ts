import type { RequestOptions } from "../connection/connection";
import type { Outcome } from "../connection/requests";
import type { RequestBody } from "../protocol/codec";
import { type AttentionItem, AttentionReason } from "../protocol/generated/console_pb";
import { itemKey, mayCommand, nextItem } from "../state/selectors";
import type { Store } from "../state/store";

type Ask = (body: RequestBody, options: RequestOptions) => Promise<Outcome>;

/** A person's way through the attention queue: turns to its items, each once, and then to all of them anew. */
export class QueueNavigator {
  #store: Store;
  #ask: Ask;
  /** Keys of the items that the person turned to, until it was all of them. */
  #passed = new Set<string>();

  constructor(store: Store, ask: Ask) {
    this.#store = store;
    this.#ask = ask;
  }

  /** To the next item that still asks; undefined = there is none. */
  async next(): Promise<Outcome | undefined> {
    const gone = new Set<string>();
    for (;;) {
      const item = nextItem(this.#store.state.value, this.#passed, gone);
      if (item === undefined) return undefined;
      const outcome = await this.select(item);
      if (outcome.kind !== "refused") return outcome;
      gone.add(itemKey(item));
    }
  }

  /** Shows what it is about, and tells the service that somebody works on it. */
  select(item: AttentionItem): Promise<Outcome> {
    const { robot, reason, world } = item;
    const { state, selections, chosenSequence, tool } = this.#store;
    this.#pass(itemKey(item));
    selections.value += 1;
    this.#store.choose(robot);
    chosenSequence.value = undefined;
    this.#store.centre(item.cell ?? state.value.robots.get(robot)?.cell);
    // Who only watches works on nothing.
    if (!mayCommand(state.value)) return Promise.resolve({ kind: "accepted", revision: 0 });
    if (wantsPath(reason) && !state.value.session?.drives) tool.value = "path";
    return this.#ask({ case: "select", value: { robot, reason } }, { world });
  }

  #pass(key: string): void {
    this.#passed.add(key);
    const items = this.#store.state.value.attention?.items ?? [];
    if (items.every((item) => this.#passed.has(itemKey(item)))) this.#passed = new Set([key]);
  }
}

/** A path is the only answer: the tool for it is taken up. */
function wantsPath(reason: AttentionReason): boolean {
  const { REASON_FIRST_PATH, REASON_NO_GUIDANCE } = AttentionReason;
  return reason === REASON_FIRST_PATH || reason === REASON_NO_GUIDANCE;
}
