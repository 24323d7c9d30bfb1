import { describe, expect, it } from "vitest";
import type { Link } from "../connection/connection";
import { linkProblem } from "./link_banner";

const lost: Link = { state: "lost", attempt: 2, retryAt: 5 };

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
