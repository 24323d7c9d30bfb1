import { describe, expect, it } from "vitest";
import type { Link } from "../connection/connection";
import { Mode, TaskPhase } from "../protocol/generated/console_pb";
import { emptyState } from "../state/console_state";
import { updates, welcomeMessage } from "../state/fixtures";
import { reduce } from "../state/reduce";
import { isCalmBetween, linkProblem } from "./link_banner";

const lost: Link = { state: "lost", attempt: 2, retryAt: 5 };

describe("between two steps", () => {
  const step = (number: number, phase: TaskPhase) =>
    reduce(
      reduce(emptyState, welcomeMessage({ mode: Mode.STUDY })),
      updates([{ case: "task", value: { number, count: 3, phase } }]),
    );
  const finished = step(1, TaskPhase.PHASE_FINISHED);

  it("the service may be away for a while, after the last one for good", () => {
    expect(isCalmBetween(finished, lost)).toBe(true);
    expect(isCalmBetween(finished, { ...lost, attempt: 99 })).toBe(false);
    expect(isCalmBetween(step(3, TaskPhase.PHASE_FINISHED), { ...lost, attempt: 99 })).toBe(true);
  });

  it("a page that is refused says so, and so does one whose step is under way", () => {
    expect(isCalmBetween(finished, { state: "closed", reason: "revoked" })).toBe(false);
    expect(isCalmBetween(step(1, TaskPhase.PHASE_RUNNING), lost)).toBe(false);
  });
});

describe("a problem of the link", () => {
  it("is none while it is live, nor while a new page connects", () => {
    expect(linkProblem({ state: "live" }, true)).toBeUndefined();
    expect(linkProblem({ state: "connecting" }, false)).toBeUndefined();
  });

  it("keeps its text while the page reconnects", () => {
    expect(linkProblem({ state: "connecting" }, true)).toBe(linkProblem(lost, true));
  });

  it("has another text while the page shows no data yet", () => {
    expect(linkProblem(lost, false)).toBeDefined();
    expect(linkProblem(lost, false)).not.toBe(linkProblem(lost, true));
  });

  it("gives the service's reason for closing the connection", () => {
    expect(linkProblem({ state: "closed", reason: "the token is not known" }, false)).toMatch(
      /the token is not known/,
    );
  });
});
