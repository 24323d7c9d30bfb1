import type { ConsoleState } from "../../state/console_state";
import { type Holder, holderOf } from "../../state/selectors";
import type { TakeOver } from "../../state/store";
import { duration } from "../format";
import { isTask } from "../task/task_state";

interface Held {
  /** Wall time of the service. */
  readonly until: number;
  /** Run of the service. */
  readonly run: string;
}

/** s; control that ends earlier before its time did not expire. */
const nearlyOver = 1;
/** s before control ends that a warning comes. */
const warning = 15;

/** Remembers which robots this page controls, also while disconnected, and says why it lost control. */
export class ControlMonitor {
  readonly #mine = new Map<string, Held>();
  readonly #releasing = new Set<string>();
  /** Robots whose holders this page asked for control. */
  readonly #asked = new Map<string, "sent" | "seen">();
  /** Ends of control that were warned of. */
  readonly #warned = new Map<string, number>();
  #seen: ConsoleState["controls"] | undefined;

  /** The person releases these robots, so their loss is not reported. */
  beginRelease(robots: readonly string[]): void {
    for (const robot of robots) this.#releasing.add(robot);
  }

  /** This page asked the holders of these robots for control. */
  asked(robots: readonly string[]): void {
    for (const robot of robots) this.#asked.set(robot, "sent");
  }

  /** What became of such questions since the previous call, as texts. */
  answers(state: ConsoleState): string[] {
    return [...this.#asked].flatMap(([robot, known]) => {
      const holder = holderOf(state, robot);
      const asks = state.controls.get(robot)?.askedBy === state.welcome?.client;
      if (asks) this.#asked.set(robot, "seen");
      // The reply may come before the question does.
      if (asks || (known === "sent" && holder.kind !== "me")) return [];
      this.#asked.delete(robot);
      if (holder.kind === "me") return [`You have control of ${robot} now.`];
      return [`${holder.kind === "other" ? holder.name : "Nobody"} keeps control of ${robot}.`];
    });
  }

  /** The release was refused. */
  cancelRelease(robots: readonly string[]): void {
    for (const robot of robots) this.#releasing.delete(robot);
  }

  /** Losses of control since the previous call, as texts. `now`: wall time of the service. */
  update(state: ConsoleState, now: number): string[] {
    // After a Welcome the state is still the old one until its updates arrive.
    if (state.controls === this.#seen) return [];
    this.#seen = state.controls;
    if (isTask(state)) return []; // control ends by itself between mazes
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
    return [...lost].map(([why, robots]) => `You no longer control ${robots.join(", ")}: ${why}`);
  }

  /** Robots whose control ends soon, once for each end. */
  endingSoon(state: ConsoleState, now: number): readonly string[] {
    if (isTask(state)) return [];
    return [...state.controls.keys()].filter((robot) => {
      const holder = holderOf(state, robot);
      if (holder.kind !== "me" || holder.until - now > warning || holder.until < now) return false;
      if (this.#warned.get(robot) === holder.until) return false;
      this.#warned.set(robot, holder.until);
      return true;
    });
  }
}

function whyLost(held: Held, holder: Holder, state: ConsoleState, now: number): string {
  if (holder.kind === "other") {
    return `${holder.name} took over${holder.reason && ` (“${holder.reason}”)`}.`;
  }
  return `${howEnded(held, state, now)} Press “Take control” to get it back.`;
}

function howEnded({ until, run }: Held, state: ConsoleState, now: number): string {
  if (run !== state.run) return "the service restarted.";
  if (until - now > nearlyOver) return "the connection was lost for too long.";
  const limit = state.welcome?.limits?.controlTime;
  return `you were inactive for ${duration(limit)}.`;
}

/** The take-over of `robots`, and from whom; from nobody needs no reason. */
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

/** The reason that others read, also in the log; undefined if it is too short. */
export function reasonOf(text: string): string | undefined {
  const reason = text.trim();
  return reason.length >= 3 ? reason : undefined;
}
