// Colours as pixels of an ImageData: 0xAABBGGRR on a Uint32Array, on every machine that has a browser.

export type Pixel = number;

export const transparent: Pixel = 0;

/** `alpha`: from 0 to 1. */
export function pixel(red: number, green: number, blue: number, alpha: number): Pixel {
  const byte = (value: number) => Math.min(255, Math.max(0, Math.round(value)));
  return ((byte(255 * alpha) << 24) | (byte(blue) << 16) | (byte(green) << 8) | byte(red)) >>> 0;
}

function channels(of: Pixel): [number, number, number, number] {
  return [of & 255, (of >>> 8) & 255, (of >>> 16) & 255, (of >>> 24) / 255];
}

/** `above`, with its opacity times `strength`, drawn over `below`. */
export function over(below: Pixel, above: Pixel, strength: number): Pixel {
  const [red, green, blue, opacity] = channels(above);
  const [redBelow, greenBelow, blueBelow, opacityBelow] = channels(below);
  const share = opacity * strength;
  const rest = opacityBelow * (1 - share);
  const all = share + rest;
  if (all <= 0) return transparent;
  const mix = (a: number, b: number) => (a * share + b * rest) / all;
  return pixel(mix(red, redBelow), mix(green, greenBelow), mix(blue, blueBelow), all);
}

const read = new Map<string, Pixel>();

/** The pixel of a CSS colour; grey where there is no canvas to read it from. */
export function pixelOf(colour: string): Pixel {
  const known = read.get(colour);
  if (known !== undefined) return known;
  const found = readPixel(colour);
  read.set(colour, found);
  return found;
}

function readPixel(colour: string): Pixel {
  const canvas = document.createElement("canvas");
  canvas.width = 1;
  canvas.height = 1;
  const context = canvas.getContext("2d");
  if (!context) return pixel(128, 128, 128, 1);
  context.fillStyle = colour;
  context.fillRect(0, 0, 1, 1);
  const [red = 0, green = 0, blue = 0, alpha = 0] = context.getImageData(0, 0, 1, 1).data;
  return pixel(red, green, blue, alpha / 255);
}
