import type { Link } from "../connection/connection";

/**
 * Why what the page shows may be old; undefined = it is not. The same words as long as the problem is the same, also while the page
 * tries to come back. `shows`: whether the page has been welcomed before, and shows something.
 */
export function linkProblem(link: Link, shows: boolean): string | undefined {
  switch (link.state) {
    case "live":
      return undefined;
    case "stale":
      return "Nothing comes from the operator service: what you see may be old.";
    case "closed":
      return `The operator service closed the connection: ${link.reason}. Reload the page to try again.`;
    case "connecting":
      return shows ? lost : undefined;
    case "lost":
      return shows ? lost : "The operator service cannot be reached.";
  }
}

const lost = "Connection lost: what you see is old. Robots stop when their commands end.";
