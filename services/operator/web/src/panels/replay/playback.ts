import type { Actions } from "../../app/actions";
import { useConsole } from "../../app/console";
import type { Clock } from "../../connection/clock";
import { type Mark, MarkKind } from "../../protocol/generated/console_pb";
import type { Store } from "../../state/store";

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

/** Recorded seconds per second. */
export const speeds = [0.5, 1, 2, 4, 8, 16, 32] as const;

/** s; a mark this near is the current one. */
const here = 0.25;

/** The mark before (-1) or after (1) `position`, of `kind` or any. */
export function markFrom(
  marks: readonly Mark[],
  position: number,
  direction: -1 | 1,
  kind?: MarkKind,
): Mark | undefined {
  const ahead = marks.filter(
    (mark) =>
      (kind === undefined || mark.kind === kind) && (mark.position - position) * direction > here,
  );
  return ahead.reduce<Mark | undefined>(
    (best, mark) =>
      best === undefined || (mark.position - best.position) * direction < 0 ? mark : best,
    undefined,
  );
}

export const markNames: readonly (readonly [MarkKind, string])[] = [
  [MarkKind.MARK_SNAPSHOT, "picture"],
  [MarkKind.MARK_EDIT, "edit"],
  [MarkKind.MARK_GUIDANCE, "path"],
  [MarkKind.MARK_ALERT, "alert"],
  [MarkKind.MARK_GOAL, "goal"],
  [MarkKind.MARK_NOTE, "note"],
];

/** What the play button does: pause, resume at speed `before`, or restart at the end. */
export function played(
  { position, duration, speed }: { position: number; duration: number; speed: number },
  before: number,
): { position?: number; speed: number } {
  if (speed > 0) return { speed: 0 };
  return position >= duration - here ? { position: 0, speed: before } : { speed: before };
}

export interface SeekTarget {
  /** s since the start of the recording. */
  readonly position?: number;
  /** Recorded seconds per second; 0 = pause. */
  readonly speed?: number;
}

/** s between two requests; a dragged slider changes faster than the service accepts. */
export const seekPeriod = 0.1;

/** Sends seek requests: the first at once, then only the newest per period. */
export class Seeker {
  #seek: (to: SeekTarget) => void;
  #clock: Clock;
  #next: SeekTarget | undefined;
  #resting = false;

  constructor(seek: (to: SeekTarget) => void, clock: Clock) {
    this.#seek = seek;
    this.#clock = clock;
  }

  seek(to: SeekTarget): void {
    this.#next = { ...this.#next, ...to };
    if (!this.#resting) this.#ask();
  }

  #ask(): void {
    const to = this.#next;
    this.#next = undefined;
    this.#resting = to !== undefined;
    if (to === undefined) return;
    this.#seek(to);
    this.#clock.after(seekPeriod, () => this.#ask());
  }
}
