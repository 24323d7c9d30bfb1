import { useEffect, useState } from "preact/hooks";
import { useConsole } from "../../app/console";
import type { Snapshot } from "../../protocol/generated/console_pb";
import type { PixelState } from "./pixels";

/** The image of a picture, or why there is none. */
export function PictureImage({ picture }: { picture: Snapshot }) {
  return picture.bytes === 0 ? (
    <div class="pixels none">This robot has no camera. The map shows what it saw.</div>
  ) : (
    <FetchedImage key={`${picture.robot} ${picture.sequenceNumber}`} picture={picture} />
  );
}

function FetchedImage({ picture }: { picture: Snapshot }) {
  const { robot, sequenceNumber, width, height } = picture;
  const [tries, setTries] = useState(0);
  const state = usePixels(picture, tries);
  if (state.kind === "ready") {
    const text = `Picture ${sequenceNumber} of ${robot}`;
    return <img class="pixels" src={state.url} alt={text} width={width} height={height} />;
  }
  return (
    <div class="pixels none">
      {state.kind === "loading" ? (
        "…"
      ) : (
        <>
          {state.reason}
          <button type="button" onClick={() => setTries(tries + 1)}>
            Try again
          </button>
        </>
      )}
    </div>
  );
}

const loading: PixelState = { kind: "loading" };

/** The image of a picture while a component shows it. A missing one is fetched again when the picture or `tries` changes. */
export function usePixels(picture: Snapshot, tries = 0): PixelState {
  const { pixels, store } = useConsole();
  const [state, setState] = useState<PixelState>(loading);
  const { run } = store.state.value;
  useEffect(() => {
    const key = { run, robot: picture.robot, sequence: picture.sequenceNumber };
    const unsubscribe = pixels.acquire(key).subscribe(setState);
    return () => {
      unsubscribe();
      pixels.release(key);
    };
  }, [pixels, run, picture, tries]);
  return state;
}
