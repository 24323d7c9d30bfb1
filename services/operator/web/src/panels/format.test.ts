import { describe, expect, it } from "vitest";
import { bytesText, count, duration, measured, milliseconds, percent, playTime } from "./format";

describe("numbers", () => {
  it.each([
    [0.42, "0.4 s"],
    [9.96, "10 s"],
    [119, "119 s"],
    [180, "3 min"],
    [7200, "2 h"],
    [undefined, "–"],
    [Number.POSITIVE_INFINITY, "–"],
  ])("last %s", (seconds, text) => {
    expect(duration(seconds)).toBe(text);
  });

  it("are written short", () => {
    expect(milliseconds(0.0454)).toBe("45 ms");
    expect(milliseconds(1.24)).toBe("1.2 s");
    expect(percent(0.705)).toBe("71 %");
    expect(measured(0)).toBe("–");
    expect(measured(2.345)).toBe("2.3");
    expect(playTime(65.9)).toBe("1:05");
    expect(playTime(3723)).toBe("1:02:03");
    expect([27, 1234, 10_200].map(bytesText)).toEqual(["27 B", "1.2 kB", "10 kB"]);
    expect(count(1, "wall")).toBe("1 wall");
    expect(count(2, "wall")).toBe("2 walls");
  });
});
