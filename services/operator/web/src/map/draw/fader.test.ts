// @vitest-environment happy-dom
import { beforeEach, describe, expect, it } from "vitest";
import type { Draw } from "./context";
import { Fader } from "./fader";
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
