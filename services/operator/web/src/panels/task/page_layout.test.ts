// @vitest-environment happy-dom
import { describe, expect, it, vi } from "vitest";
import { followLayout, measureLayout } from "./page_layout";

/** happy-dom has no layout: elements say themselves where they are. */
function place(element: Element, x: number, y: number, width: number, height: number) {
  element.getBoundingClientRect = () => new DOMRect(x, y, width, height);
}

function page() {
  document.body.innerHTML = `
    <div data-area="map"><canvas data-view="10 20 16" data-world="w1"></canvas></div>
    <section data-area="picture" data-robot="r1"></section>
    <section data-area="queue"></section>
    <svg><rect data-tag="3" /></svg>`;
  const at = (selector: string) => document.querySelector(selector) as Element;
  place(at("[data-area=map]"), 0, 0, 500, 500);
  place(at("canvas"), 5, 40, 400, 300);
  place(at("[data-area=picture]"), 600, 50, 200, 100);
  place(at("[data-tag]"), 12, 12, 96, 96);
  return at;
}

describe("the layout of the page", () => {
  it("has areas and tags with a size, and where the map's cells are", () => {
    page();
    expect(measureLayout(document)).toMatchObject({
      areas: [
        { name: "map", robot: "", x: 5, y: 40, width: 400, height: 300 },
        { name: "picture", robot: "r1", x: 600, y: 50, width: 200, height: 100 },
      ],
      tags: [{ name: "tag3", x: 12, y: 12, width: 96, height: 96 }],
      world: "w1",
      mapX: 5 + 10 + 8,
      mapY: 40 + 20 + 8,
      mapDx: 16,
      mapDy: 16,
    });
  });

  it("has no map while the canvas shows none", () => {
    const at = page();
    at("canvas").removeAttribute("data-view");
    const layout = measureLayout(document);
    expect(layout.world ?? "").toBe("");
    expect(layout.areas).toMatchObject([{ name: "map", width: 500 }, { name: "picture" }]);
  });

  it("is that of a dialog alone while one is open", () => {
    page();
    document.body.insertAdjacentHTML("beforeend", "<dialog open></dialog>");
    place(document.querySelector("dialog") as Element, 300, 100, 200, 150);
    const layout = measureLayout(document);
    expect(layout.areas).toMatchObject([{ name: "dialog", x: 300, width: 200 }]);
    expect(layout.world ?? "").toBe("");
  });

  it("is reported when it changes, a burst of changes once, until nobody follows", async () => {
    const at = page();
    const reports: unknown[] = [];
    const end = followLayout(document, (layout) => reports.push(layout));
    const reported = (times: number) =>
      vi.waitFor(() => expect(reports).toHaveLength(times), { timeout: 5000 });
    await reported(1);
    at("canvas").setAttribute("class", "other"); // moves nothing
    for (const view of ["0 0 16", "1 0 16", "2 0 16"]) at("canvas").setAttribute("data-view", view);
    await reported(2);
    expect(reports[1]).toMatchObject({ mapX: 5 + 2 + 8 });
    end();
    at("canvas").setAttribute("data-view", "9 0 16");
    await new Promise((resolve) => setTimeout(resolve, 400));
    expect(reports).toHaveLength(2);
  });
});
