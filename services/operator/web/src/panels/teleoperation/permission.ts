import type { Link } from "../../connection/connection";
import type { Timing } from "../../connection/timing";
import type { ConsoleState } from "../../state/console_state";
import { freshnessOf } from "../../state/freshness";
import { whyNotCommand } from "../../state/selectors";
import { isTask, whyNotMap } from "../task/task_state";

/** s of round trip beyond which nobody should drive, or may; as usual where the service names none. */
export function driveLimits({ welcome }: Pick<ConsoleState, "welcome">) {
  return {
    advisedAgainst: welcome?.limits?.driveAdvisedAgainst || 0.3,
    refused: welcome?.limits?.driveRefused || 1,
  };
}

/** Why `robot` cannot be driven now, in words; undefined = it can. `now`: wall time of the service. */
export function whyNotDrive(
  state: ConsoleState,
  link: Link,
  { roundTrip }: Timing,
  now: number | undefined,
  robot: string,
): string | undefined {
  if (!state.session?.drives) return "this method is not driven by hand";
  if (link.state !== "live") return "the connection is not live";
  const forbidden = whyNotCommand(state, robot);
  if (forbidden !== undefined) return forbidden;
  const begins = isTask(state) ? whyNotMap(state) : undefined;
  if (begins !== undefined) return begins;
  if (state.controls.get(robot)?.stopped) return `${robot} is stopped: G lets it go on`;
  if (!state.robots.has(robot)) return `${robot} is not heard yet`;
  if (freshnessOf(state.robots.get(robot)?.heardAt, now, true) === "lost")
    return `${robot} is lost`;
  if (roundTrip === undefined) return "the round trip is not measured yet";
  const { refused } = driveLimits(state);
  return roundTrip > refused ? `the round trip is above ${refused} s` : undefined;
}

export function isAdvisedAgainst(state: ConsoleState, { roundTrip }: Timing): boolean {
  return (roundTrip ?? 0) > driveLimits(state).advisedAgainst;
}
