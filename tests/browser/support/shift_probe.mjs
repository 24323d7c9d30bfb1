/**
 * Runs in the page. Records whatever moves or scales the map after it was drawn first, but for changes of the window: a press must
 * hit what the person saw. `conavShifts` is a list of texts.
 */
export function shiftProbe() {
  globalThis.conavShifts = [];
  const shifts = globalThis.conavShifts;
  let canvas;
  let size = "";
  let resizedAt = Number.NEGATIVE_INFINITY;
  let shownAt = Number.NEGATIVE_INFINITY;
  const ofMap = (node) => canvas !== undefined && node instanceof Element && node.contains(canvas);
  new PerformanceObserver((list) => {
    for (const { sources, startTime } of list.getEntries()) {
      // What moved in the frame that first shows the map moved nothing that anybody saw.
      if (startTime < Math.max(resizedAt + 1000, shownAt + 100)) continue;
      for (const { node, previousRect: from, currentRect: to } of sources) {
        if (!ofMap(node)) continue;
        const name = `${node.tagName} ${node.className}`;
        shifts.push(`${name}: ${from.x},${from.y} -> ${to.x},${to.y}`);
      }
    }
  }).observe({ type: "layout-shift" });
  const look = () => {
    const now = document.querySelector("canvas.map-surface") ?? undefined;
    const box = now?.getBoundingClientRect();
    const seen = box ? `${box.x},${box.y} ${box.width}x${box.height}` : "";
    if (now && now === canvas && seen !== size) shifts.push(`canvas: ${size} -> ${seen}`);
    if (now !== canvas) shownAt = performance.now();
    canvas = now;
    size = seen;
    requestAnimationFrame(look);
  };
  addEventListener("resize", () => {
    canvas = undefined;
    resizedAt = performance.now();
  });
  requestAnimationFrame(look);
}
