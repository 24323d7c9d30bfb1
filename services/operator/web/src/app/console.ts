import type { Signal } from "@preact/signals";
import { createContext } from "preact";
import { useContext } from "preact/hooks";
import type { Tour } from "../panels/guide/tour";
import type { Pixels } from "../panels/pictures/pixels";
import type { Teleoperation } from "../panels/robots/teleoperation";
import type { History } from "../panels/status/workload_history";
import type { Store } from "../state/store";
import type { Actions } from "./actions";
import type { Commands } from "./shortcuts";

/** Passed to every panel. */
export interface Console {
  readonly store: Store;
  readonly actions: Actions;
  readonly commands: Commands;
  readonly teleoperation: Teleoperation;
  readonly pixels: Pixels;
  readonly tour: Tour;
  readonly history: Signal<History>;
  /** Changes the name that other people see. */
  rename(name: string): Promise<void>;
}

export const ConsoleContext = createContext<Console | undefined>(undefined);

export function useConsole(): Console {
  const found = useContext(ConsoleContext);
  if (found === undefined) throw new Error("a panel is outside of the console");
  return found;
}
