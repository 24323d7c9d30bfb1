import { beforeEach, describe, expect, it } from "vitest";
import { FramePainter } from "./live_view";

interface FakeFrame {
  readonly width: number;
  readonly height: number;
  close(): void;
}

let asked: number[];
let decoded: ((frame: FakeFrame) => void)[];
let failed: ((error: Error) => void)[];
let drawn: FakeFrame[];
let closed: number;
let painter: FramePainter<FakeFrame>;

const canvas = {
  width: 0,
  height: 0,
  getContext: () => ({ drawImage: (frame: FakeFrame) => void drawn.push(frame) }),
};
const frame = (width: number): FakeFrame => ({ width, height: 10, close: () => (closed += 1) });
const settled = () => new Promise((resolve) => setTimeout(resolve, 0));
const paint = (number: number) => painter.paint(Uint8Array.of(number), canvas);

beforeEach(() => {
  asked = [];
  decoded = [];
  failed = [];
  drawn = [];
  closed = 0;
  painter = new FramePainter((jpeg) => {
    asked.push(jpeg[0] ?? 0);
    return new Promise((resolve, reject) => {
      decoded.push(resolve);
      failed.push(reject);
    });
  });
});

describe("frames", () => {
  it("are drawn in their own size, and closed", async () => {
    paint(1);
    decoded[0]?.(frame(320));
    await settled();
    expect(canvas.width).toBe(320);
    expect([drawn.length, closed]).toEqual([1, 1]);
  });

  it("are decoded one at a time; of those in between only the newest is drawn", async () => {
    paint(1);
    paint(2);
    paint(3);
    expect(asked).toEqual([1]);
    decoded[0]?.(frame(1));
    await settled();
    expect(asked).toEqual([1, 3]);
  });

  it("that are no pictures do not stop those that follow", async () => {
    paint(1);
    failed[0]?.(new Error("not a JPEG"));
    await settled();
    paint(2);
    decoded[1]?.(frame(2));
    await settled();
    expect(drawn).toHaveLength(1);
  });
});
