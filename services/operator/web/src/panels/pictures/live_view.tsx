import { useEffect, useMemo, useRef } from "preact/hooks";
import { useConsole } from "../../app/console";
import { ageOf, frameStaleAfter } from "../../state/freshness";
import { count, duration } from "../format";

/** The newest frame of a robot that streams, with its age; dimmed when it is old. */
export function LiveView({ robot }: { robot: string }) {
  const { store } = useConsole();
  const frame = store.state.value.frames.get(robot);
  const age = ageOf(frame?.receivedAt, store.now.value);
  const old = age === undefined || age > frameStaleAfter || !store.linked.value;
  return (
    <>
      <h2>Live view of {robot}</h2>
      <figure class={`live-view ${old ? "old" : ""}`}>
        {/* One canvas per robot, so that no robot shows a frame of another. */}
        <FrameCanvas key={robot} robot={robot} jpeg={frame?.jpeg} />
        <figcaption class={old ? "bad" : "good"}>{caption(age, old)}</figcaption>
        {frame !== undefined && frame.skipped > 0n && (
          <span class="quiet skipped">{count(Number(frame.skipped), "frame")} skipped</span>
        )}
      </figure>
    </>
  );
}

function FrameCanvas({ robot, jpeg }: { robot: string; jpeg: Uint8Array | undefined }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const painter = useMemo(() => new FramePainter(decodeJpeg), []);
  useEffect(() => {
    if (jpeg !== undefined && canvas.current) painter.paint(jpeg, canvas.current);
  }, [jpeg, painter]);
  return <canvas ref={canvas} role="img" aria-label={`Live view of ${robot}`} />;
}

function decodeJpeg(jpeg: Uint8Array): Promise<ImageBitmap> {
  return createImageBitmap(new Blob([new Uint8Array(jpeg)], { type: "image/jpeg" }));
}

function caption(age: number | undefined, old: boolean): string {
  if (age === undefined) return "NO VIDEO";
  return old ? `AGE ${duration(age)}` : `● live, ${duration(age)}`;
}

interface DecodedFrame {
  readonly width: number;
  readonly height: number;
  close(): void;
}

/** The part of a canvas that FramePainter uses. */
interface FrameSurface<Frame> {
  width: number;
  height: number;
  getContext(kind: "2d"): { drawImage(frame: Frame, x: number, y: number): void } | null;
}

/** Draws frames in order. Decodes one at a time; of the frames that arrive in between it keeps only the newest. */
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
      // Not a JPEG: the previous frame stays.
    }
  }
}
