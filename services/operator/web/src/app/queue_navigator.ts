import type { RequestOptions } from "../connection/connection";
import type { Outcome } from "../connection/requests";
import type { RequestBody } from "../protocol/codec";
import { type AttentionItem, AttentionReason } from "../protocol/generated/console_pb";
import { itemKey, mayCommand, nextItem, waitingItems } from "../state/selectors";
import type { Store } from "../state/store";

type Ask = (body: RequestBody, options: RequestOptions) => Promise<Outcome>;

/** Steps through the attention queue: visits each item once, then starts over. */
export class QueueNavigator {
  #store: Store;
  #ask: Ask;
  /** Keys of the items visited in this round. */
  #passed = new Set<string>();

  constructor(store: Store, ask: Ask) {
    this.#store = store;
    this.#ask = ask;
  }

  /** Selects the next item that still needs attention; undefined = there is none. */
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

  /** Shows the item's robot, picture and map, and reports to the service that somebody works on it. */
  select(item: AttentionItem): Promise<Outcome> {
    const { robot, reason, world } = item;
    const { state, selections, chosenSequence, tool } = this.#store;
    this.#pass(itemKey(item));
    selections.value += 1;
    this.#store.choose(robot);
    chosenSequence.value = undefined;
    this.#store.centre(item.cell ?? state.value.robots.get(robot)?.cell);
    // Observers select nothing at the service.
    if (!mayCommand(state.value)) return Promise.resolve({ kind: "accepted", revision: 0 });
    if (needsPath(reason) && !state.value.session?.drives) tool.value = "path";
    return this.#ask({ case: "select", value: { robot, reason } }, { world });
  }

  #pass(key: string): void {
    this.#passed.add(key);
    const items = waitingItems(this.#store.state.value);
    if (items.every((item) => this.#passed.has(itemKey(item)))) this.#passed = new Set([key]);
  }
}

/** Whether only a path can answer, so that the path tool is chosen. */
function needsPath(reason: AttentionReason): boolean {
  const { REASON_FIRST_PATH, REASON_NO_GUIDANCE } = AttentionReason;
  return reason === REASON_FIRST_PATH || reason === REASON_NO_GUIDANCE;
}
