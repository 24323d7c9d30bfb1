import type { ConsoleState } from "../../state/console_state";
import { holderOf } from "../../state/selectors";
import type { TakeOver } from "../../state/store";

/** Whom it takes control from, if anybody: then a reason is asked for. */
export function takeOverOf(state: ConsoleState, robots: readonly string[]): TakeOver {
  const names = robots.flatMap((robot) => {
    const holder = holderOf(state, robot);
    return holder.kind === "other" ? [holder.name] : [];
  });
  return { robots, from: [...new Set(names)] };
}

export function needsReason({ from }: TakeOver): boolean {
  return from.length > 0;
}

/** What is said to the others, and in the log; undefined while it is none. */
export function reasonOf(text: string): string | undefined {
  const reason = text.trim();
  return reason.length >= 3 ? reason : undefined;
}
