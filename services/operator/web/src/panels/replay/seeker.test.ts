import { beforeEach, describe, expect, it } from "vitest";
import { FakeClock } from "../../connection/fake";
import { type Place, Seeker, seekPeriod } from "./seeker";

let clock: FakeClock;
let asked: Place[];
let seeker: Seeker;

beforeEach(() => {
  clock = new FakeClock();
  asked = [];
  seeker = new Seeker((to) => asked.push(to), clock);
});

describe("seeking", () => {
  it("asks for the first place at once", () => {
    seeker.seek({ position: 1 });
    expect(asked).toEqual([{ position: 1 }]);
  });

  it("asks for the newest of those that follow quickly, once", () => {
    for (const position of [1, 2, 3]) seeker.seek({ position });
    clock.advance(10 * seekPeriod);
    expect(asked).toEqual([{ position: 1 }, { position: 3 }]);
  });

  it("loses no speed by a place that is asked for after it", () => {
    seeker.seek({ position: 1 });
    seeker.seek({ speed: 4 });
    seeker.seek({ position: 2 });
    clock.advance(seekPeriod);
    expect(asked.at(-1)).toEqual({ position: 2, speed: 4 });
  });

  it("asks at once again after a pause", () => {
    seeker.seek({ position: 1 });
    clock.advance(5 * seekPeriod);
    seeker.seek({ position: 2 });
    expect(asked).toHaveLength(2);
  });
});
