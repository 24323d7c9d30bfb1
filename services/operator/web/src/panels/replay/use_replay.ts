import type { Actions } from "../../app/actions";
import { useConsole } from "../../app/console";
import type { Store } from "../../state/store";
import { markFrom, played } from "./marks";

export function togglePlay(store: Store, actions: Actions): void {
  const playback = store.state.value.playback;
  if (playback) actions.seek(played(playback, store.replaySpeed.value));
}

export function jump(store: Store, actions: Actions, direction: -1 | 1): void {
  const playback = store.state.value.playback;
  const mark = playback && markFrom(playback.marks, playback.position, direction);
  if (mark) actions.seek({ position: mark.position });
}

export function useReplay() {
  const { store, actions } = useConsole();
  return {
    toggle: () => togglePlay(store, actions),
    speed: store.replaySpeed.value,
    setSpeed: (speed: number) => {
      store.replaySpeed.value = speed;
      if ((store.state.value.playback?.speed ?? 0) > 0) actions.seek({ speed });
    },
  };
}
