/** Timing of the connection in s. */
export interface Timing {
  /** Round trip of the newest answered ping, or the age of the oldest unanswered one if that is longer. */
  readonly roundTrip: number | undefined;
  /** Service's wall time minus the page's time. */
  readonly clockOffset: number | undefined;
}

interface Sample {
  readonly roundTrip: number;
  readonly offset: number;
}

const window = 16;
/** s that two clocks may drift apart between pings. */
const clockDrift = 0.005;

/** Whether both samples fit the same clocks. If not, a clock was set or this computer slept in between. */
function agree(a: Sample, b: Sample): boolean {
  return Math.abs(a.offset - b.offset) <= (a.roundTrip + b.roundTrip) / 2 + clockDrift;
}

/**
 * Round trip and clock offset from pings. The newest pings' shortest round trip gives the best offset: its error is at most half
 * of that round trip.
 */
export class TimingFilter {
  #samples: Sample[] = [];
  #underWay: number[] = [];
  #offset: number | undefined;

  /**
   * `serviceTime` of a Welcome: less exact than a ping, but available at once. The message took time to arrive, so the true offset
   * is not lower. A lower offset dates from before this computer slept, when the page's time stood still.
   */
  welcomed(serviceTime: number, now: number): void {
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

  /** The connection broke: pending pings are lost, the offset stays. */
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
