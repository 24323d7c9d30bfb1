// Where the page shows what, for a study with an eye tracker: elements with data-area (and data-robot), tags with data-tag,
// and the map's canvas, which keeps its view in data-view.
import type { Layout } from "../../protocol/codec";

/** ms between two looks at the page while it changes. */
const period = 250;

interface Rectangle {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

/** In CSS pixels of the window. Elements without a size are left out. */
export function measureLayout(page: Document): Layout {
  const { innerWidth: width = 0, innerHeight: height = 0 } = page.defaultView ?? {};
  const canvas = page.querySelector<HTMLElement>("canvas[data-view]");
  // What is under a dialog is not seen.
  const dialog = page.querySelector<HTMLElement>("dialog[open]");
  const panels = dialog !== null ? [] : [...page.querySelectorAll<HTMLElement>("[data-area]")];
  const areas = panels.map((element) => {
    // The map is what is drawn, without the bars around it.
    const seen = canvas !== null && element.contains(canvas) ? canvas : element;
    const { area = "", robot = "" } = element.dataset;
    return { name: area, robot, ...rectangleOf(seen) };
  });
  const tags = [...page.querySelectorAll<SVGElement>("[data-tag]")].map((element) => ({
    name: `tag${element.dataset.tag}`,
    ...rectangleOf(element),
  }));
  const hasSize = (one: Rectangle) => one.width > 0 && one.height > 0;
  return {
    width,
    height,
    pixelRatio: page.defaultView?.devicePixelRatio ?? 1,
    areas: (dialog === null
      ? areas
      : [{ name: "dialog", robot: "", ...rectangleOf(dialog) }]
    ).filter(hasSize),
    tags: tags.filter(hasSize),
    ...(dialog === null && canvas !== null && hasSize(rectangleOf(canvas)) ? mapOn(canvas) : {}),
  };
}

function rectangleOf(element: Element): Rectangle {
  const { x, y, width, height } = element.getBoundingClientRect();
  return { x, y, width, height };
}

/** The view as map/canvas_view.ts writes it. */
function mapOn(canvas: HTMLElement): Layout {
  const { world = "", view = "" } = canvas.dataset;
  const [x = 0, y = 0, scale = 0] = view.split(" ").map(Number);
  const corner = rectangleOf(canvas);
  return {
    world,
    mapX: corner.x + x + scale / 2,
    mapY: corner.y + y + scale / 2,
    mapDx: scale,
    mapDy: scale,
  };
}

/** Calls `report` with each new layout, until the returned function is called. */
export function followLayout(page: Document, report: (layout: Layout) => void): () => void {
  let last = "";
  let later: ReturnType<typeof setTimeout> | undefined;
  const look = () => {
    later = undefined;
    const layout = measureLayout(page);
    const text = JSON.stringify(layout);
    if (text === last || page.hidden) return;
    last = text;
    report(layout);
  };
  const changed = () => {
    later ??= setTimeout(look, period);
  };
  const changes = new MutationObserver(changed);
  changes.observe(page.documentElement, {
    subtree: true,
    childList: true,
    attributes: true,
    attributeFilter: [
      "class",
      "style",
      "open",
      "data-area",
      "data-robot",
      "data-view",
      "data-world",
    ],
  });
  const sizes = new ResizeObserver(changed);
  sizes.observe(page.documentElement);
  const options = { capture: true, passive: true };
  for (const kind of ["scroll", "load", "visibilitychange"]) {
    page.addEventListener(kind, changed, options);
  }
  changed();
  return () => {
    clearTimeout(later);
    changes.disconnect();
    sizes.disconnect();
    for (const kind of ["scroll", "load", "visibilitychange"]) {
      page.removeEventListener(kind, changed, options);
    }
  };
}
