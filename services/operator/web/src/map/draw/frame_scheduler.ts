/** At most one frame waits to be drawn, and none while nothing changes. */
export class FrameScheduler {
  #draw: () => void;
  #pending: number | undefined;

  constructor(draw: () => void) {
    this.#draw = draw;
  }

  request(): void {
    this.#pending ??= requestAnimationFrame(() => {
      this.#pending = undefined;
      this.#draw();
    });
  }

  /** At once, such as before the first paint in a new size. */
  drawNow(): void {
    this.stop();
    this.#draw();
  }

  stop(): void {
    if (this.#pending !== undefined) cancelAnimationFrame(this.#pending);
    this.#pending = undefined;
  }
}
