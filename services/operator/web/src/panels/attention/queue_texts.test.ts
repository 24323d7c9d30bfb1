import { create } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { AttentionItemSchema, AttentionReason } from "../../protocol/generated/console_pb";
import { emptyState } from "../../state/console_state";
import { stateOf, type UpdateBody } from "../../state/fixtures";
import { adviceText, emptyQueueText, patienceText, reasonText } from "./queue_texts";

describe("what a robot wants", () => {
  const { REASON_FIRST_PATH } = AttentionReason;

  it("is to be driven where that is the method", () => {
    expect(reasonText(REASON_FIRST_PATH, true)).toContain("driven");
    expect(adviceText(REASON_FIRST_PATH, true)).toContain("arrow keys");
    expect(reasonText(REASON_FIRST_PATH, false)).toContain("path");
  });
});

describe("how long it waits", () => {
  const item = (value: { deadline?: number; givesUpAfter?: number }) =>
    create(AttentionItemSchema, value);

  it("counts down in the operator's time", () => {
    expect(patienceText(item({ deadline: 20 }), 8)).toBe(", goes on alone in 12 s");
    expect(patienceText(item({ deadline: 20 }), 30)).toBe(", goes on alone in 0.0 s");
  });

  it("is a length of time where the robot goes by the wall clock", () => {
    expect(patienceText(item({ givesUpAfter: 10 }), 8)).toBe(", goes on alone after 10 s");
  });

  it("is not told of what waits for ever", () => {
    expect(patienceText(item({}), 8)).toBe("");
  });
});

describe("an empty queue", () => {
  const session: UpdateBody = { case: "session", value: { robots: ["r1", "r2"] } };
  const stopped = (robot: string): UpdateBody => ({
    case: "control",
    value: { robot, stopped: true },
  });

  it("is nobody's while the service is heard", () => {
    expect(emptyQueueText(stateOf(session, stopped("r1")), "live")).toMatch(/^Nobody/);
    expect(emptyQueueText(stateOf(), "live")).toMatch(/No robot/);
  });

  it("of robots that are all stopped says so", () => {
    const state = stateOf(session, stopped("r1"), stopped("r2"));
    expect(emptyQueueText(state, "live")).toBe("All robots are stopped.");
  });

  it("tells nothing while nothing is known", () => {
    expect(emptyQueueText(stateOf(session), "lost")).toMatch(/while the connection is lost/);
    expect(emptyQueueText(stateOf(session), "connecting")).toMatch(/while the connection is lost/);
    expect(emptyQueueText(emptyState, "connecting")).toBe("Not known yet.");
    expect(emptyQueueText(emptyState, "closed")).toMatch(/without a connection/);
  });
});
