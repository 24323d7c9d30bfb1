import { beforeEach, describe, expect, it } from "vitest";
import { TimingFilter } from "./timing";

let timing: TimingFilter;
const offset = () => timing.timing(0).clockOffset;

/** A ping sent at `now`, answered after `roundTrip` by a service whose clock is `ahead`. */
function ping(now: number, roundTrip: number, ahead: number): void {
  timing.sent(now);
  timing.answered(now, now + roundTrip / 2 + ahead, now + roundTrip);
}

beforeEach(() => {
  timing = new TimingFilter();
});

describe("the clock offset", () => {
  it("comes from the quickest of the newest pings", () => {
    timing.sent(1);
    timing.answered(1, 101.3, 1.4); // slow to go, quick to come back
    expect(offset()).toBeCloseTo(100.1);
    ping(2, 0.02, 100);
    expect(offset()).toBeCloseTo(100);
    ping(3, 0.4, 100.1);
    expect(offset()).toBeCloseTo(100);
  });

  it("follows at once a clock that was set, or a computer that slept", () => {
    ping(1, 0.02, 100);
    ping(2, 0.4, 3700);
    expect(offset()).toBeCloseTo(3700);
    ping(3, 0.4, 50);
    expect(offset()).toBeCloseTo(50);
  });

  it("is known with the Welcome, and no Welcome makes a good one worse", () => {
    timing.welcomed(101, 1);
    expect(offset()).toBeCloseTo(100);
    ping(2, 0.02, 100.1);
    timing.forget();
    timing.welcomed(103, 3); // it took 0.1 s to come
    expect(offset()).toBeCloseTo(100.1);
  });

  it("from before a sleep is replaced by the Welcome after it", () => {
    ping(1, 0.02, 100);
    timing.forget();
    timing.welcomed(3702, 2);
    expect(offset()).toBeCloseTo(3700);
  });
});

describe("the round trip", () => {
  it("is that of the newest answer, until another ping waits longer", () => {
    ping(1, 0.2, 100);
    timing.sent(2);
    expect(timing.timing(2.1).roundTrip).toBeCloseTo(0.2);
    expect(timing.timing(2.7).roundTrip).toBeCloseTo(0.7);
  });

  it("does not count a ping that was answered, nor those before it, as waiting", () => {
    timing.sent(1);
    timing.sent(2);
    timing.answered(2, 102, 2.1);
    expect(timing.timing(9).roundTrip).toBeCloseTo(0.1);
  });
});
