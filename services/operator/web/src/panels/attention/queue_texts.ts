import type { Link } from "../../connection/connection";
import { type AttentionItem, AttentionReason } from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";
import { areAllStopped, robotNames } from "../../state/selectors";
import { duration } from "../format";

/** Why a robot needs the operator; follows its name. `drives`: the operator drives by keys and draws no paths. */
export function reasonText(reason: AttentionReason, drives: boolean): string {
  switch (reason) {
    case AttentionReason.REASON_SNAPSHOT:
      return "sent a picture";
    case AttentionReason.REASON_BLOCKED:
      return "is blocked by a wall";
    case AttentionReason.REASON_NO_GUIDANCE:
      return "needs a path";
    case AttentionReason.REASON_FIRST_PATH:
      return drives ? "is waiting to be driven" : "has no path yet";
    case AttentionReason.REASON_COMMAND_FAILED:
      return "is idle: its command failed";
    case AttentionReason.REASON_LINK_LOST:
      return "is not responding";
    default:
      return "needs you";
  }
}

/** Text of an empty queue. */
export function emptyQueueText(state: ConsoleState, link: Link["state"]): string {
  if (link === "closed") return "Unknown: not connected.";
  if (link !== "live")
    return state.welcome === undefined ? "Connecting…" : "Unknown: the connection is lost.";
  if (robotNames(state).length === 0) return "No robot has reported yet.";
  return areAllStopped(state) ? "All robots are stopped." : "Nothing is waiting.";
}

/** What the operator can do. */
export function adviceText(reason: AttentionReason, drives: boolean): string {
  switch (reason) {
    case AttentionReason.REASON_SNAPSHOT:
      return "Compare the picture with your map. Correct the map or draw a path, or answer “nothing new”.";
    case AttentionReason.REASON_BLOCKED:
      return "Draw a path around the wall.";
    case AttentionReason.REASON_NO_GUIDANCE:
    case AttentionReason.REASON_FIRST_PATH:
      return drives
        ? "Hold the arrow keys and watch its live view."
        : "Draw a path with the “Path” tool (P), from the robot to its flags.";
    case AttentionReason.REASON_COMMAND_FAILED:
      return "Check the alerts. Draw another path, or stop the robot.";
    case AttentionReason.REASON_LINK_LOST:
      return "The map shows its last position. Check the services.";
    default:
      return "";
  }
}

/** When the robot continues by itself. `now`: the run's clock. */
export function patienceText({ deadline, givesUpAfter }: AttentionItem, now: number): string {
  if (deadline > 0) return `, continues alone in ${duration(Math.max(0, deadline - now))}`;
  return givesUpAfter > 0 ? `, continues alone after ${duration(givesUpAfter)}` : "";
}
