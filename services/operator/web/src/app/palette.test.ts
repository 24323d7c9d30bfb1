import { describe, expect, it } from "vitest";
import { lookOf } from "./palette";

function luminance(colour: string): number {
  const [red = 0, green = 0, blue = 0] = [1, 3, 5]
    .map((at) => Number.parseInt(colour.slice(at, at + 2), 16) / 255)
    .map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

function contrast(a: string, b: string): number {
  const [light = 0, dark = 0] = [luminance(a), luminance(b)].sort((x, y) => y - x);
  return (light + 0.05) / (dark + 0.05);
}

describe("looks", () => {
  const looks = Array.from({ length: 16 }, (_, index) => lookOf(index));

  it("of 16 robots differ without the letter, and without the colour", () => {
    expect(new Set(looks.map(({ colour, shape }) => `${colour} ${shape}`)).size).toBe(16);
    expect(new Set(looks.map(({ letter }) => letter)).size).toBe(16);
  });

  it("stand out from both backgrounds", () => {
    for (const { colour } of looks) {
      expect(contrast(colour, "#ffffff"), `${colour} on white`).toBeGreaterThan(3);
      expect(contrast(colour, "#14181d"), `${colour} on black`).toBeGreaterThan(3);
    }
  });
});
