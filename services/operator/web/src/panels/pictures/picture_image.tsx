import { useState } from "preact/hooks";
import type { Picture } from "../../protocol/generated/console_pb";
import { usePixels } from "./use_pixels";

/** The pixels of a picture, or why there are none. */
export function PictureImage({ picture }: { picture: Picture }) {
  return picture.bytes === 0 ? (
    <div class="pixels none">The robot runs without a camera: the map shows what it saw there.</div>
  ) : (
    <FetchedImage key={`${picture.robot} ${picture.sequenceNumber}`} picture={picture} />
  );
}

function FetchedImage({ picture }: { picture: Picture }) {
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
