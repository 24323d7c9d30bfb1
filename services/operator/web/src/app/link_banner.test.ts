import { describe, expect, it } from "vitest";
import type { Link } from "../connection/connection";
import { linkProblem } from "./link_banner";

const lost: Link = { state: "lost", attempt: 2, retryAt: 5 };

describe("a problem of the link", () => {
  it("is none while it is live, nor while a new page connects", () => {
    expect(linkProblem({ state: "live" }, true)).toBeUndefined();
    expect(linkProblem({ state: "connecting" }, false)).toBeUndefined();
  });

  it("stays the same in words while the page tries to come back", () => {
    expect(linkProblem(lost, true)).toMatch(/what you see is old/);
    expect(linkProblem({ state: "connecting" }, true)).toBe(linkProblem(lost, true));
  });

  it("does not call old what is not there yet", () => {
    expect(linkProblem(lost, false)).not.toMatch(/old/);
  });

  it("says why the service closed the connection", () => {
    expect(linkProblem({ state: "closed", reason: "the token is not known" }, false)).toMatch(
      /the token is not known/,
    );
  });
});
