// The canvas element: tracks its size and theme, and draws a frame whenever its data changes.
import { effect } from "@preact/signals";
import { type Palette, readPalette, watchTheme } from "./draw/palette";
import { Easing } from "./easing";
import { attachKeyboard } from "./keyboard_input";
import type { MapModel } from "./map_model";
import { attachPointer } from "./pointer_input";
import { drawScene, type Scene, SceneCache } from "./scene";
import type { ToolDriver } from "./tool_driver";

/** Shows the map on the canvas until the returned function is called. */
export function showOn(canvas: HTMLCanvasElement, model: MapModel, driver: ToolDriver): () => void {
  const cache = new SceneCache();
  const easing = new Easing();
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  let palette = readPalette(canvas);
  const frames = new FrameScheduler(() => {
    const scene = sceneOf(model, palette);
    if (!scene) return;
    const eased = easing.at(scene.props.robots, performance.now() / 1000);
    if (calm.matches || !eased.moving) draw(canvas, scene, cache);
    else {
      draw(canvas, { ...scene, props: { ...scene.props, robots: eased.robots } }, cache);
      frames.requestLater();
    }
  });
  const ends = [
    effect(() => {
      sceneOf(model, palette); // reads every signal that a frame depends on
      frames.request();
    }),
    () => frames.stop(),
    effect(() => {
      // For eye tracking (panels/task/page_layout.ts).
      const view = model.view.value;
      canvas.dataset.world = model.calm.value.world.name;
      if (view && !model.solid.value) canvas.dataset.view = `${view.x} ${view.y} ${view.scale}`;
      else delete canvas.dataset.view;
    }),
    watchSize(canvas, model, () => frames.drawNow()),
    watchTheme(() => {
      palette = readPalette(canvas);
      frames.request();
    }),
  ];
  const panKey = { held: false, used: false };
  ends.push(attachPointer(canvas, model, driver, panKey));
  ends.push(attachKeyboard(canvas, model, driver, panKey));
  return () => {
    for (const end of ends) end();
  };
}

function sceneOf(model: MapModel, palette: Palette): Scene | undefined {
  const view = model.view.value;
  const scene = {
    props: model.props.value,
    seen: model.seen,
    palette,
    editing: model.editing.value,
    paths: [...model.paths.value.values()],
    ahead: model.ahead.value,
    cursor: model.byKeyboard.value ? model.cursor.value : undefined,
    hover: model.hover.value,
    rectangle: model.rectangle.value,
  };
  return view && { ...scene, view };
}

function watchSize(canvas: HTMLCanvasElement, model: MapModel, changed: () => void): () => void {
  const sizes = new ResizeObserver(() => {
    if (canvas.clientWidth === 0 || canvas.clientHeight === 0) return;
    model.resize(canvas.clientWidth, canvas.clientHeight);
    changed();
  });
  sizes.observe(canvas);
  return () => sizes.disconnect();
}

function draw(canvas: HTMLCanvasElement, scene: Scene, cache: SceneCache): void {
  const context = canvas.getContext("2d", { alpha: false });
  if (!context) return;
  const ratio = devicePixelRatio;
  const width = Math.round(scene.view.width * ratio);
  const height = Math.round(scene.view.height * ratio);
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width;
    canvas.height = height;
  }
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  drawScene(context, scene, cache);
}

/** ms between two frames while robots glide. */
const glidePeriod = 40;

/** Draws at most one frame per animation frame, and none while nothing changes. */
class FrameScheduler {
  #draw: () => void;
  #pending: number | undefined;
  #later: ReturnType<typeof setTimeout> | undefined;

  constructor(draw: () => void) {
    this.#draw = draw;
  }

  request(): void {
    clearTimeout(this.#later);
    this.#later = undefined;
    this.#pending ??= requestAnimationFrame(() => {
      this.#pending = undefined;
      this.#draw();
    });
  }

  requestLater(): void {
    this.#later ??= setTimeout(() => this.request(), glidePeriod);
  }

  /** Draws at once, for example after a resize. */
  drawNow(): void {
    this.stop();
    this.#draw();
  }

  stop(): void {
    clearTimeout(this.#later);
    this.#later = undefined;
    if (this.#pending !== undefined) cancelAnimationFrame(this.#pending);
    this.#pending = undefined;
  }
}
