import { create } from "@bufbuild/protobuf";
import { beforeEach, describe, expect, it } from "vitest";
import { FakeClock } from "../../connection/fake";
import { MarkKind, MarkSchema } from "../../protocol/generated/console_pb";
import { markFrom, played, Seeker, type SeekTarget, seekPeriod } from "./playback";

const { MARK_SNAPSHOT: picture, MARK_EDIT: edit } = MarkKind;
const marks = [
  create(MarkSchema, { kind: picture, position: 20 }),
  create(MarkSchema, { kind: picture, position: 5 }),
  create(MarkSchema, { kind: edit, position: 10 }),
];

describe("marks", () => {
  it("are found on both sides, whatever their order", () => {
    expect(markFrom(marks, 7, 1)?.position).toBe(10);
    expect(markFrom(marks, 7, -1)?.position).toBe(5);
    expect(markFrom(marks, 7, 1, picture)?.position).toBe(20);
  });

  it("are left behind when we stand on one", () => {
    expect(markFrom(marks, 10, 1)?.position).toBe(20);
    expect(markFrom(marks, 10, -1)?.position).toBe(5);
  });

  it("end at both ends", () => {
    expect(markFrom(marks, 20, 1)).toBeUndefined();
    expect(markFrom([], 0, -1)).toBeUndefined();
  });
});

describe("play", () => {
  const at = (position: number, speed: number) => ({ position, duration: 60, speed });
  it("pauses what plays, and goes on with the speed before", () => {
    expect(played(at(10, 4), 4)).toEqual({ speed: 0 });
    expect(played(at(10, 0), 4)).toEqual({ speed: 4 });
  });

  it("begins again at the end", () => {
    expect(played(at(60, 0), 1)).toEqual({ position: 0, speed: 1 });
  });
});

let clock: FakeClock;
let asked: SeekTarget[];
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
