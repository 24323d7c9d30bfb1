export interface DecodedFrame {
  readonly width: number;
  readonly height: number;
  close(): void;
}

/** What is painted on. */
export interface FrameSurface<Frame> {
  width: number;
  height: number;
  getContext(kind: "2d"): { drawImage(frame: Frame, x: number, y: number): void } | null;
}

/** Frames on a canvas, in their order: one is decoded at a time, and of those that come meanwhile only the newest. */
export class FramePainter<Frame extends DecodedFrame> {
  #decode: (jpeg: Uint8Array) => Promise<Frame>;
  #next: Uint8Array | undefined;
  #busy = false;

  constructor(decode: (jpeg: Uint8Array) => Promise<Frame>) {
    this.#decode = decode;
  }

  paint(jpeg: Uint8Array, canvas: FrameSurface<Frame>): void {
    this.#next = jpeg;
    if (!this.#busy) void this.#run(canvas);
  }

  async #run(canvas: FrameSurface<Frame>): Promise<void> {
    this.#busy = true;
    while (this.#next !== undefined) {
      const jpeg = this.#next;
      this.#next = undefined;
      await this.#show(jpeg, canvas);
    }
    this.#busy = false;
  }

  async #show(jpeg: Uint8Array, canvas: FrameSurface<Frame>): Promise<void> {
    try {
      const frame = await this.#decode(jpeg);
      canvas.width = frame.width;
      canvas.height = frame.height;
      canvas.getContext("2d")?.drawImage(frame, 0, 0);
      frame.close();
    } catch {
      // Not a picture: the old one stays, and grows old on screen.
    }
  }
}
