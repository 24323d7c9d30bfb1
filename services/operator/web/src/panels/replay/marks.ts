import { type Mark, MarkKind } from "../../protocol/generated/console_pb";

/** Recorded seconds per second. */
export const speeds = [0.5, 1, 2, 4, 8, 16, 32] as const;

/** A mark this near, s, is the one that we stand on. */
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
  [MarkKind.MARK_PICTURE, "picture"],
  [MarkKind.MARK_EDIT, "edit"],
  [MarkKind.MARK_GUIDANCE, "path"],
  [MarkKind.MARK_ALERT, "alert"],
  [MarkKind.MARK_GOAL, "goal"],
];

/** What playing on means: the speed before the pause, or 1; at the end it begins again. */
export function played(
  { position, duration, speed }: { position: number; duration: number; speed: number },
  before: number,
): { position?: number; speed: number } {
  if (speed > 0) return { speed: 0 };
  return position >= duration - here ? { position: 0, speed: before } : { speed: before };
}
