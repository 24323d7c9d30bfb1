/** Records a canvas as a film. */
export class ClipRecorder {
  #recorder: MediaRecorder;
  #parts: Blob[] = [];

  /** Undefined where the browser cannot record. */
  static begin(canvas: HTMLCanvasElement): ClipRecorder | undefined {
    if (typeof MediaRecorder === "undefined" || !("captureStream" in canvas)) return undefined;
    if (!MediaRecorder.isTypeSupported("video/webm")) return undefined;
    return new ClipRecorder(canvas.captureStream(framesPerSecond));
  }

  private constructor(stream: MediaStream) {
    this.#recorder = new MediaRecorder(stream, { mimeType: "video/webm" });
    this.#recorder.addEventListener("dataavailable", ({ data }) => this.#parts.push(data));
    this.#recorder.start();
  }

  /** Ends, and hands the film to the browser as a file of this name. */
  async save(name: string): Promise<void> {
    const ended = new Promise((resolve) => this.#recorder.addEventListener("stop", resolve));
    this.#recorder.stop();
    await ended;
    for (const track of this.#recorder.stream.getTracks()) track.stop();
    const url = URL.createObjectURL(new Blob(this.#parts, { type: "video/webm" }));
    const link = document.createElement("a");
    link.href = url;
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(url), 60_000);
  }
}

const framesPerSecond = 15;
