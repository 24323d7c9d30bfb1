import type { ConsoleState } from "../../state/console_state";
import { type Holder, holderOf } from "../../state/selectors";
import type { TakeOver } from "../../state/store";
import { duration } from "../format";
import { isTask } from "../task/task_state";

interface Held {
  /** Wall time of the service. */
  readonly until: number;
  /** Of the service. */
  readonly run: string;
}

/** s; control that ends earlier than this before its time did not run out. */
const nearlyOver = 1;

/** Remembers which robots this page controls, also while it knows nothing of them, and says why it controls them no more. */
export class ControlMonitor {
  readonly #mine = new Map<string, Held>();
  readonly #releasing = new Set<string>();
  #seen: ConsoleState["controls"] | undefined;

  /** They are released by hand: no news. */
  releases(robots: readonly string[]): void {
    for (const robot of robots) this.#releasing.add(robot);
  }

  /** They were not. */
  keeps(robots: readonly string[]): void {
    for (const robot of robots) this.#releasing.delete(robot);
  }

  /** What there is to say since the look before. `now`: wall time of the service. */
  look(state: ConsoleState, now: number): string[] {
    // A new Welcome comes before what is new.
    if (state.controls === this.#seen) return [];
    this.#seen = state.controls;
    if (isTask(state)) return []; // between mazes it ends without anybody's doing
    const lost = new Map<string, string[]>();
    for (const robot of state.controls.keys()) {
      const holder = holderOf(state, robot);
      const held = this.#mine.get(robot);
      if (holder.kind === "me") {
        this.#mine.set(robot, { until: holder.until, run: state.run });
      } else if (held !== undefined) {
        this.#mine.delete(robot);
        if (this.#releasing.delete(robot)) continue;
        const why = whyLost(held, holder, state, now);
        lost.set(why, [...(lost.get(why) ?? []), robot]);
      }
    }
    return [...lost].map(([why, robots]) => `You control ${robots.join(", ")} no more: ${why}`);
  }
}

function whyLost(held: Held, holder: Holder, state: ConsoleState, now: number): string {
  if (holder.kind === "other") {
    return `${holder.name} took over${holder.reason && ` (“${holder.reason}”)`}.`;
  }
  return `${howEnded(held, state, now)} “Take control” gives it back.`;
}

function howEnded({ until, run }: Held, state: ConsoleState, now: number): string {
  if (run !== state.run) return "the service was started anew.";
  if (until - now > nearlyOver) return "the connection was lost for too long.";
  const limit = state.welcome?.limits?.controlTime;
  return `the service heard nothing of you for ${duration(limit)}.`;
}

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
