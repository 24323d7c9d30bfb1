import { type ReadonlySignal, type Signal, signal } from "@preact/signals";
import type { Clock } from "../../connection/clock";
import { type Alert, Severity } from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";
import { itemKey, waitingItems } from "../../state/selectors";
import { reasonText } from "./queue_texts";

export interface Announcement {
  readonly text: string;
  /** Interrupts the screen reader. */
  readonly urgent: boolean;
}

/** New items of the queue and new alerts between two states. Nothing that was there when the page opened. */
export function announcementsOf(
  before: ConsoleState,
  after: ConsoleState,
): readonly Announcement[] {
  if (before.session === undefined || before.run !== after.run) return [];
  return [...alertAnnouncements(before, after), ...attentionAnnouncements(before, after)];
}

function attentionAnnouncements(before: ConsoleState, after: ConsoleState): Announcement[] {
  if (before.attention === after.attention) return [];
  const known = new Set(waitingItems(before).map(itemKey));
  const fresh = waitingItems(after).filter((item) => !known.has(itemKey(item)));
  return fresh.map(({ robot, reason }) => ({
    text: `${robot} ${reasonText(reason, after.session?.drives ?? false)}`,
    urgent: false,
  }));
}

function alertAnnouncements(before: ConsoleState, after: ConsoleState): Announcement[] {
  if (before.alerts === after.alerts) return [];
  const known = new Set(before.alerts.filter(({ active }) => active).map(({ id }) => id));
  const calls = ({ active, acknowledgedBy, shelvedUntil, newest }: Alert) =>
    active && acknowledgedBy === "" && shelvedUntil <= newest;
  const fresh = after.alerts.filter((alert) => calls(alert) && !known.has(alert.id));
  return fresh.map(({ severity, source, text }) => ({
    text: `Alert, ${source}: ${text}`,
    urgent: severity === Severity.ALARM,
  }));
}

/** s between two announcements, so that a screen reader can finish. */
const announcePeriod = 4;
const mostAtOnce = 3;

/** Texts of the page's two live regions. Announcements in quick succession are joined. */
export class Announcer {
  readonly #polite = signal("");
  readonly #urgent = signal("");
  #clock: Clock;
  #waiting: Announcement[] = [];
  #quietUntil = Number.NEGATIVE_INFINITY;

  constructor(clock: Clock) {
    this.#clock = clock;
  }

  get polite(): ReadonlySignal<string> {
    return this.#polite;
  }

  get urgent(): ReadonlySignal<string> {
    return this.#urgent;
  }

  announce(announcements: readonly Announcement[]): void {
    if (announcements.length === 0) return;
    const idle = this.#waiting.length === 0;
    this.#waiting.push(...announcements);
    const wait = this.#quietUntil - this.#clock.now();
    if (wait <= 0) this.#speak();
    else if (idle) this.#clock.after(wait, () => this.#speak());
  }

  #speak(): void {
    const announcements = this.#waiting;
    this.#waiting = [];
    this.#quietUntil = this.#clock.now() + announcePeriod;
    const of = (wanted: boolean) => announcements.filter(({ urgent }) => urgent === wanted);
    speak(this.#urgent, of(true));
    speak(this.#polite, of(false));
  }
}

/** Screen readers skip an unchanged text, so a repeated one gets a silent space at its end. */
function speak(region: Signal<string>, announcements: readonly Announcement[]): void {
  const text = joined(announcements);
  region.value = text !== "" && text === region.peek() ? `${text}\u00a0` : text;
}

function joined(announcements: readonly Announcement[]): string {
  const texts = announcements.slice(0, mostAtOnce).map(({ text }) => text);
  const more = announcements.length - texts.length;
  return texts.concat(more > 0 ? [`and ${more} more`] : []).join(". ");
}
