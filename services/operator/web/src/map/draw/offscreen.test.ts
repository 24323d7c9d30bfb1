// @vitest-environment happy-dom
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import type { Draw } from "./context";
import { CachedLayer, Fader } from "./offscreen";
import { RecordingContext } from "./recording";

const view = { scale: 10, x: 0, y: 0, width: 40, height: 30 };

describe("a layer", () => {
  let onto: RecordingContext;
  const paint = (on: Draw) => on.fillRect(1, 2, 3, 4);

  beforeEach(() => {
    onto = new RecordingContext();
  });

  it("is not drawn at strength 0, and directly at 1", () => {
    new Fader().draw(onto, view, 0, paint);
    expect(onto.calls).toEqual([]);
    new Fader().draw(onto, view, 1, paint);
    expect(onto.named("fillRect")).toHaveLength(1);
    expect(onto.named("drawImage")).toEqual([]);
  });

  it("is put on the map as a whole between", () => {
    const on = new RecordingContext();
    const image = document.createElement("canvas");
    new Fader(() => ({ on, image })).draw(onto, view, 0.4, paint);
    expect(on.named("fillRect")).toHaveLength(1);
    expect(onto.named("fillRect")).toEqual([]);
    expect(onto.named("drawImage")[0]?.values).toEqual([image, 0, 0, 40, 30]);
    expect(onto.globalAlpha).toBe(0.4);
  });

  it("is drawn fully where there is nothing else to draw on", () => {
    new Fader(() => undefined).draw(onto, view, 0.4, paint);
    expect(onto.named("fillRect")).toHaveLength(1);
  });
});

/** A layer after the first frame with `view`. */
function shown() {
  const layer = new CachedLayer();
  layer.draw(new RecordingContext(), view, [], () => undefined);
  return { onto: new RecordingContext(), layer, paint: vi.fn() };
}

/** What is drawn on the layer's own canvas. */
let own: RecordingContext;

function withCanvas(context: object | undefined): void {
  const canvas = { width: 0, height: 0, getContext: () => context };
  vi.stubGlobal("document", { createElement: () => canvas });
}

describe("a layer that is kept from frame to frame", () => {
  beforeEach(() => {
    own = new RecordingContext();
    withCanvas(Object.assign(own, { setTransform: () => undefined }));
    vi.stubGlobal("devicePixelRatio", 2);
  });

  afterEach(() => vi.unstubAllGlobals());

  it("is painted when something that it shows has changed, and copied into each frame", () => {
    const { onto, layer, paint } = shown();
    layer.draw(onto, view, ["a", 1], paint);
    layer.draw(onto, view, ["a", 1], paint);
    layer.draw(onto, view, ["a", 2], paint);
    expect(paint.mock.calls).toEqual([[own], [own]]);
    const copies = onto.named("drawImage");
    expect(copies.map(({ values }) => values.slice(1))).toEqual(Array(3).fill([0, 0, 40, 30]));
  });

  it("is painted right into the frame while the view moves", () => {
    const { onto, layer, paint } = shown();
    for (const x of [1, 2]) layer.draw(onto, { ...view, x }, ["a"], paint);
    expect(paint.mock.calls).toEqual([[onto], [onto]]);
    expect(onto.named("drawImage")).toEqual([]);
  });

  it("gets more drawn over it while all else stays the same", () => {
    const { layer, paint } = shown();
    const add = vi.fn();
    layer.draw(new RecordingContext(), view, ["a"], paint, add);
    expect(add).not.toHaveBeenCalled();
    layer.draw(new RecordingContext(), view, ["a"], paint, add);
    expect(add).toHaveBeenCalledExactlyOnceWith(own);
  });

  it("is painted right into each frame where there is no canvas", () => {
    withCanvas(undefined);
    const onto = new RecordingContext();
    const layer = new CachedLayer();
    const paint = vi.fn();
    layer.draw(onto, view, ["a"], paint);
    layer.draw(onto, view, ["a"], paint);
    expect(paint.mock.calls).toEqual([[onto], [onto]]);
  });
});
