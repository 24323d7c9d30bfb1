import type { Link } from "../../connection/connection";
import { type AttentionItem, AttentionReason } from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";
import { robotNames } from "../../state/selectors";
import { duration } from "../format";

/** What a robot wants of the operator, to follow its name. `drives`: by keys, in place of paths. */
export function reasonText(reason: AttentionReason, drives: boolean): string {
  switch (reason) {
    case AttentionReason.REASON_PICTURE:
      return "sent a picture";
    case AttentionReason.REASON_BLOCKED:
      return "is blocked by a wall and waits";
    case AttentionReason.REASON_NO_GUIDANCE:
      return "needs a path";
    case AttentionReason.REASON_FIRST_PATH:
      return drives ? "waits to be driven" : "has no path yet";
    case AttentionReason.REASON_COMMAND_FAILED:
      return "stands: its command failed";
    case AttentionReason.REASON_LINK_LOST:
      return "is not heard any more";
    case AttentionReason.REASON_GOALS_REACHED:
      return "has reached all its goals";
    default:
      return "asks for you";
  }
}

/** While nothing is in the queue. */
export function emptyQueueText(state: ConsoleState, link: Link["state"]): string {
  if (link === "closed") return "Not known without a connection.";
  if (link !== "live")
    return state.welcome === undefined
      ? "Not known yet."
      : "Not known while the connection is lost.";
  const robots = robotNames(state);
  if (robots.length === 0) return "No robot was heard of yet.";
  const allStopped = robots.every((name) => state.controls.get(name)?.stopped);
  return allStopped ? "All robots are stopped." : "Nobody. The robots get along.";
}

/** For information: nobody waits. */
export function isNotice(reason: AttentionReason): boolean {
  return reason === AttentionReason.REASON_GOALS_REACHED;
}

/** What to do about it. */
export function adviceText(reason: AttentionReason, drives: boolean): string {
  switch (reason) {
    case AttentionReason.REASON_PICTURE:
      return "Compare the picture with your map: edit walls, then draw a path, or answer “nothing new”.";
    case AttentionReason.REASON_BLOCKED:
      return "Draw a path around the wall.";
    case AttentionReason.REASON_NO_GUIDANCE:
    case AttentionReason.REASON_FIRST_PATH:
      return drives
        ? "Hold the arrow keys, and look at its live view."
        : "Draw its way with the tool “Path” (P): from the robot to its flags.";
    case AttentionReason.REASON_COMMAND_FAILED:
      return "Look at the alerts; draw another path, or stop it.";
    case AttentionReason.REASON_LINK_LOST:
      return "Its newest position stays on the map; look at the services.";
    default:
      return "";
  }
}

/** When it goes on by itself. `now`: of the operator's time, as in Attention.stamp. */
export function patienceText({ deadline, givesUpAfter }: AttentionItem, now: number): string {
  if (deadline > 0) return `, goes on alone in ${duration(Math.max(0, deadline - now))}`;
  return givesUpAfter > 0 ? `, goes on alone after ${duration(givesUpAfter)}` : "";
}
