/** Of the connection, as far as known: s. */
export interface Timing {
  /** Of the newest answered ping, or how long the oldest unanswered one has been under way, if longer. */
  readonly roundTrip: number | undefined;
  /** Service's wall time minus the page's time. */
  readonly clockOffset: number | undefined;
}

interface Sample {
  readonly roundTrip: number;
  readonly offset: number;
}

const window = 16;

/**
 * Round trip and clock offset from pings. Of the newest pings the one with the least round trip tells the offset best: its error
 * is at most half of that round trip.
 */
export class TimingFilter {
  #samples: Sample[] = [];
  #underWay: number[] = [];
  #offset: number | undefined;

  /** `serviceTime` of a Welcome: less exact than any ping, but there at once. The first one counts. */
  greet(serviceTime: number, now: number): void {
    this.#offset ??= serviceTime - now;
  }

  sent(now: number): void {
    this.#underWay.push(now);
  }

  answered(pageTime: number, serviceTime: number, now: number): void {
    if (!this.#underWay.includes(pageTime)) return;
    this.#underWay = this.#underWay.filter((sent) => sent > pageTime);
    const roundTrip = now - pageTime;
    this.#samples.push({ roundTrip, offset: serviceTime + roundTrip / 2 - now });
    this.#samples = this.#samples.slice(-window);
    const best = this.#samples.reduce((a, b) => (b.roundTrip <= a.roundTrip ? b : a));
    this.#offset = best.offset;
  }

  /** The connection broke: what was under way is lost, the round trip may be another one, the offset stays. */
  forget(): void {
    this.#samples = [];
    this.#underWay = [];
  }

  /** Round trip of the newest answered ping; 0 = none yet. */
  measured(): number {
    return this.#samples.at(-1)?.roundTrip ?? 0;
  }

  timing(now: number): Timing {
    return { roundTrip: this.#roundTrip(now), clockOffset: this.#offset };
  }

  #roundTrip(now: number): number | undefined {
    const newest = this.#samples.at(-1)?.roundTrip;
    const oldest = this.#underWay[0];
    if (oldest === undefined) return newest;
    const waiting = now - oldest;
    return newest === undefined || waiting > newest ? waiting : newest;
  }
}
