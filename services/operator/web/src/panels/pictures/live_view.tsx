import { Maximize2, X } from "lucide-preact";
import { useEffect, useMemo, useRef } from "preact/hooks";
import { useConsole } from "../../app/console";
import type { Frame } from "../../protocol/generated/console_pb";
import { ageOf, frameStaleAfter } from "../../state/freshness";
import { bytesText, count, duration } from "../format";
import { isTask } from "../task/task_state";

/** The newest frame of a robot's camera, with its age, and what it costs; dimmed when it is old. `large`: over the map. */
export function LiveView({ robot, large = false }: { robot: string; large?: boolean }) {
  const { store, actions } = useConsole();
  const frame = store.state.value.frames.get(robot);
  const age = ageOf(frame?.receivedAt, store.now.value);
  const old = age === undefined || age > frameStaleAfter || !store.linked.value;
  const opened = store.cameras.value.includes(robot);
  const participates = isTask(store.state.value);
  return (
    <figure class={`live-view ${frame === undefined ? "none" : old ? "old" : ""}`}>
      {/* One canvas per robot, so that no robot shows a frame of another. */}
      <FrameCanvas key={robot} robot={robot} jpeg={frame?.jpeg} />
      <figcaption>
        <strong>{robot}</strong> <span class={old ? "bad" : "good"}>{caption(age, old)}</span>
      </figcaption>
      <span class="acts">
        {!large && !participates && (
          <button
            type="button"
            aria-label={`Enlarge the live view of ${robot}`}
            onClick={() => {
              store.large.value = { kind: "camera", robot };
            }}
          >
            <Maximize2 size={14} />
          </button>
        )}
        {opened && !large && (
          <button
            type="button"
            aria-label={`Close the camera of ${robot}`}
            onClick={() => actions.toggleCamera(robot)}
          >
            <X size={14} />
          </button>
        )}
      </span>
      {!participates && <Cost frame={frame} />}
    </figure>
  );
}

/** Frames and bytes of a second, and frames that the page was too slow for. */
function Cost({ frame }: { frame: Frame | undefined }) {
  const { now } = useConsole().store;
  const rates = useMemo(() => new FrameRates(), []);
  if (frame !== undefined) rates.add(frame);
  const { perSecond, bytesPerSecond } = rates.at(now.value ?? 0);
  return (
    <span class="cost quiet">
      {perSecond.toFixed(1)}/s, {bytesText(bytesPerSecond)}/s
      {frame !== undefined && frame.skipped > 0n && (
        <>, {count(Number(frame.skipped), "frame")} skipped</>
      )}
    </span>
  );
}

/** s over which rates are measured. */
const rateWindow = 3;

/** How many frames and bytes come in a second. */
export class FrameRates {
  #frames: { readonly number: bigint; readonly at: number; readonly bytes: number }[] = [];

  add({ number, receivedAt, jpeg }: Pick<Frame, "number" | "receivedAt" | "jpeg">): void {
    if (this.#frames.at(-1)?.number === number) return;
    this.#frames.push({ number, at: receivedAt, bytes: jpeg.length });
  }

  /** `now`: wall time, as Frame.receivedAt. */
  at(now: number): { readonly perSecond: number; readonly bytesPerSecond: number } {
    this.#frames = this.#frames.filter(({ at }) => now - at <= rateWindow);
    const bytes = this.#frames.reduce((sum, frame) => sum + frame.bytes, 0);
    return {
      perSecond: this.#frames.length / rateWindow,
      bytesPerSecond: Math.round(bytes / rateWindow),
    };
  }
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
  return old ? `AGE ${duration(age)}` : `live, ${duration(age)}`;
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
