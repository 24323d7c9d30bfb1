import { useEffect, useState } from "preact/hooks";
import { useConsole } from "../../app/console";
import type { Picture } from "../../protocol/generated/console_pb";
import type { PixelState } from "./pixels";

const loading: PixelState = { kind: "loading" };

/** The pixels of a picture as long as a component shows it; missing ones are asked for again with news of it, and when `tries` changes. */
export function usePixels(picture: Picture, tries = 0): PixelState {
  const { pixels, store } = useConsole();
  const [state, setState] = useState<PixelState>(loading);
  const { run } = store.state.value;
  useEffect(() => {
    const shot = { run, robot: picture.robot, sequence: picture.sequenceNumber };
    const unsubscribe = pixels.acquire(shot).subscribe(setState);
    return () => {
      unsubscribe();
      pixels.release(shot);
    };
  }, [pixels, run, picture, tries]);
  return state;
}
