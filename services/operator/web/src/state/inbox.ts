import type { Clock } from "../connection/clock";
import type { ServerMessage } from "../protocol/generated/console_pb";
import type { Store } from "./store";

/** s between two changes of what is shown: quicker than anybody sees, slower than many robots tell. */
const showPeriod = 0.03;

/** Brings messages to the store: the first at once, those that follow quickly together. */
export class Inbox {
  #store: Store;
  #clock: Clock;
  #shown: () => void;
  #waiting: ServerMessage[] = [];
  #resting = false;

  /** `shown` is called whenever everything that came is in the store. */
  constructor(store: Store, clock: Clock, shown: () => void) {
    this.#store = store;
    this.#clock = clock;
    this.#shown = shown;
  }

  receive(message: ServerMessage): void {
    this.#waiting.push(message);
    if (!this.#resting) this.#show();
  }

  /** Everything that came is in the store afterwards. */
  empty(): void {
    const messages = this.#waiting;
    this.#waiting = [];
    if (messages.length === 0) return;
    this.#store.receive(...messages);
    this.#shown();
  }

  #show(): void {
    this.#resting = this.#waiting.length > 0;
    if (!this.#resting) return;
    this.empty();
    this.#clock.after(showPeriod, () => this.#show());
  }
}
