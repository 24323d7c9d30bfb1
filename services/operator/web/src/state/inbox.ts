import type { Clock } from "../connection/clock";
import type { ServerMessage } from "../protocol/generated/console_pb";
import type { Store } from "./store";

/** s between two updates of the screen: faster than people see, slower than many robots report. */
const showPeriod = 0.03;

/** Passes messages to the store: the first at once, quick followers as a batch. */
export class Inbox {
  #store: Store;
  #clock: Clock;
  #shown: () => void;
  #waiting: ServerMessage[] = [];
  #resting = false;

  /** `shown` is called whenever all messages are in the store. */
  constructor(store: Store, clock: Clock, shown: () => void) {
    this.#store = store;
    this.#clock = clock;
    this.#shown = shown;
  }

  receive(message: ServerMessage): void {
    this.#waiting.push(message);
    if (!this.#resting) this.#show();
  }

  /** Puts all waiting messages into the store now. */
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
