import { describe, expect, it } from "vitest";
import { at, FakePage } from "./fixtures";
import { MapModel } from "./map_model";

const focusOn = (counter: number) => new FakePage({ focus: { cell: at(3, 5), counter } }).props;

describe("centring on a cell", () => {
  it("moves nothing while all of the map is in sight", () => {
    const model = new MapModel(new FakePage().props);
    model.resize(400, 300);
    const before = model.view.value;
    model.update(focusOn(1));
    expect(model.view.value).toEqual(before);
  });

  it("brings the cell to the middle of a map that was zoomed into, once", () => {
    const model = new MapModel(new FakePage().props);
    model.resize(400, 300);
    model.zoom(3);
    model.update(focusOn(1));
    const { x, scale } = model.view.value ?? { x: 0, scale: 0 };
    expect(x + 5.5 * scale).toBeCloseTo(24 + (400 - 24) / 2);
    model.zoom(1.1);
    const zoomed = model.view.value;
    model.update(focusOn(1));
    expect(model.view.value).toEqual(zoomed);
  });
});

describe("zooming out", () => {
  it("ends where all of the map is in sight", () => {
    const model = new MapModel(new FakePage().props);
    model.resize(400, 300);
    const all = model.view.value;
    for (const factor of [0.5, 3, 0.01]) model.zoom(factor, { x: 10, y: 200 });
    expect(model.view.value).toEqual(all);
    model.zoom(2);
    expect(model.view.value?.scale).toBeCloseTo(2 * (all?.scale ?? 0));
  });
});
