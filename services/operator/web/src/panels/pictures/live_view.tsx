import { useEffect, useRef } from "preact/hooks";
import { useConsole } from "../../app/console";
import { ageOf, frameStaleAfter } from "../../state/freshness";
import { duration } from "../format";

/** The newest frame of a robot that streams, with its age; dimmed when it is no live view any more. */
export function LiveView({ robot }: { robot: string }) {
  const { store } = useConsole();
  const frame = store.state.value.frames.get(robot);
  const canvas = useRef<HTMLCanvasElement>(null);
  const jpeg = frame?.jpeg;
  useEffect(() => {
    if (jpeg !== undefined && canvas.current) void draw(jpeg, canvas.current);
  }, [jpeg]);
  const age = ageOf(frame?.heardAt, store.now.value);
  const old = age === undefined || age > frameStaleAfter || !store.linked.value;
  return (
    <>
      <h2>Live view of {robot}</h2>
      <figure class={`live-view ${old ? "old" : ""}`}>
        <canvas ref={canvas} role="img" aria-label={`Live view of ${robot}`} />
        <figcaption class={old ? "bad" : "good"}>{caption(age, old)}</figcaption>
        {frame !== undefined && frame.skipped > 0n && (
          <span class="quiet skipped">{String(frame.skipped)} frames skipped</span>
        )}
      </figure>
    </>
  );
}

function caption(age: number | undefined, old: boolean): string {
  if (age === undefined) return "NO VIDEO";
  return old ? `AGE ${duration(age)}` : `● live, ${duration(age)}`;
}

async function draw(jpeg: Uint8Array, canvas: HTMLCanvasElement): Promise<void> {
  try {
    const image = await createImageBitmap(new Blob([new Uint8Array(jpeg)], { type: "image/jpeg" }));
    canvas.width = image.width;
    canvas.height = image.height;
    canvas.getContext("2d")?.drawImage(image, 0, 0);
    image.close();
  } catch {
    // Not a picture: the old one stays, and grows old on screen.
  }
}
