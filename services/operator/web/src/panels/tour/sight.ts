import type { Store } from "../../state/store";
import type { Sight } from "./tour_steps";

export function sightOf({ state, chosenRobot, turns }: Store): Sight {
  return { state: state.value, chosenRobot: chosenRobot.value, turns: turns.value };
}
