import { beforeEach, describe, expect, it, vi } from "vitest";
import type { View } from "../view";
import { CachedLayer } from "./cached_layer";
import { RecordingContext } from "./recording";

const view: View = { scale: 4, x: 0, y: 0, width: 100, height: 50 };

/** What is drawn on the layer's own canvas. */
let own: RecordingContext;

function withCanvas(context: object | undefined): void {
  const canvas = { width: 0, height: 0, getContext: () => context };
  vi.stubGlobal("document", { createElement: () => canvas });
}

beforeEach(() => {
  own = new RecordingContext();
  withCanvas(Object.assign(own, { setTransform: () => undefined }));
  vi.stubGlobal("devicePixelRatio", 2);
});

describe("a layer that is kept from frame to frame", () => {
  it("is painted when something that it shows or the view has changed, and copied in each frame", () => {
    const onto = new RecordingContext();
    const layer = new CachedLayer();
    const paint = vi.fn();
    layer.draw(onto, view, ["a", 1], paint);
    layer.draw(onto, view, ["a", 1], paint);
    expect(paint).toHaveBeenCalledTimes(1);
    layer.draw(onto, view, ["a", 2], paint);
    layer.draw(onto, { ...view, x: 5 }, ["a", 2], paint);
    expect(paint).toHaveBeenCalledTimes(3);
    const copies = onto.calls.filter(({ name }) => name === "drawImage");
    expect(copies.map(({ values }) => values.slice(1))).toEqual(Array(4).fill([0, 0, 100, 50]));
  });

  it("gets more drawn over it while all else stays the same", () => {
    const layer = new CachedLayer();
    const add = vi.fn();
    layer.draw(new RecordingContext(), view, ["a"], () => undefined, add);
    expect(add).not.toHaveBeenCalled();
    layer.draw(new RecordingContext(), view, ["a"], () => undefined, add);
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
