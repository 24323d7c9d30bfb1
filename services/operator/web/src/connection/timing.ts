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
/** s by which two clocks may drift apart meanwhile. */
const clockDrift = 0.005;

/** Whether both can be true of the same clocks; if not, a clock was set, or this computer slept, in between. */
function agree(a: Sample, b: Sample): boolean {
  return Math.abs(a.offset - b.offset) <= (a.roundTrip + b.roundTrip) / 2 + clockDrift;
}

/**
 * Round trip and clock offset from pings. Of the newest pings the one with the least round trip tells the offset best: its error
 * is at most half of that round trip.
 */
export class TimingFilter {
  #samples: Sample[] = [];
  #underWay: number[] = [];
  #offset: number | undefined;

  /**
   * `serviceTime` of a Welcome: less exact than any ping, but there at once. It was said before it came, so the offset is not below:
   * one that is was measured before this computer slept, while which the page's time stood still.
   */
  greet(serviceTime: number, now: number): void {
    this.#offset = Math.max(this.#offset ?? Number.NEGATIVE_INFINITY, serviceTime - now);
  }

  sent(now: number): void {
    this.#underWay.push(now);
  }

  answered(pageTime: number, serviceTime: number, now: number): void {
    if (!this.#underWay.includes(pageTime)) return;
    this.#underWay = this.#underWay.filter((sent) => sent > pageTime);
    const roundTrip = now - pageTime;
    const sample = { roundTrip, offset: serviceTime + roundTrip / 2 - now };
    const alike = this.#samples.filter((other) => agree(other, sample));
    this.#samples = [...alike, sample].slice(-window);
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
