import { useEffect, useState } from "preact/hooks";
import { useConsole } from "../../app/console";
import type { PixelState } from "./pixels";

const loading: PixelState = { kind: "loading" };

/** The pixels of the one picture that a component shows as long as it lives; `tries` asks again when it changes. */
export function usePixels(robot: string, sequence: bigint, tries = 0): PixelState {
  const { pixels } = useConsole();
  const [state, setState] = useState<PixelState>(loading);
  useEffect(() => {
    const source = pixels.acquire(robot, sequence);
    const unsubscribe = source.subscribe(setState);
    return () => {
      unsubscribe();
      pixels.release(robot, sequence);
    };
  }, [pixels, robot, sequence, tries]);
  return state;
}
