import { create } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { AttentionItemSchema, AttentionReason } from "../../protocol/generated/console_pb";
import { emptyState } from "../../state/console_state";
import { stateOf, type UpdateBody } from "../../state/fixtures";
import { adviceText, emptyQueueText, patienceText, reasonText } from "./queue_texts";

describe("the reason of an item", () => {
  const { REASON_FIRST_PATH } = AttentionReason;

  it("does not mention paths where robots are driven by hand", () => {
    for (const text of [reasonText, adviceText]) {
      expect(text(REASON_FIRST_PATH, false)).toMatch(/path/i);
      expect(text(REASON_FIRST_PATH, true)).not.toMatch(/path/i);
    }
  });
});

describe("the time until a robot continues alone", () => {
  const item = (value: { deadline?: number; givesUpAfter?: number }) =>
    create(AttentionItemSchema, value);

  it("counts down in the operator's time", () => {
    expect(patienceText(item({ deadline: 20 }), 8)).toMatch(/ 12 s$/);
    expect(patienceText(item({ deadline: 20 }), 30)).toMatch(/ 0\.0 s$/);
  });

  it("is a duration where the robot uses the wall clock", () => {
    expect(patienceText(item({ givesUpAfter: 10 }), 8)).toMatch(/ 10 s$/);
  });

  it("is empty for robots that wait for ever", () => {
    expect(patienceText(item({}), 8)).toBe("");
  });
});

describe("an empty queue", () => {
  const session: UpdateBody = { case: "session", value: { robots: ["r1", "r2"] } };
  const stopped = (robot: string): UpdateBody => ({
    case: "robot",
    value: { name: robot, stopped: true },
  });
  const ordered = (robot: string): UpdateBody => ({
    case: "control",
    value: { robot, stopped: true },
  });

  it("has a text for each cause", () => {
    const texts = [
      emptyQueueText(stateOf(session, stopped("r1")), "live"),
      emptyQueueText(stateOf(session, stopped("r1"), stopped("r2")), "live"),
      emptyQueueText(stateOf(), "live"),
      emptyQueueText(stateOf(session), "lost"),
      emptyQueueText(emptyState, "connecting"),
      emptyQueueText(emptyState, "closed"),
    ];
    expect(new Set(texts).size).toBe(texts.length);
    expect(emptyQueueText(stateOf(session), "connecting")).toBe(texts[3]);
    const unconfirmed = stateOf(session, ordered("r1"), ordered("r2"));
    expect(emptyQueueText(unconfirmed, "live")).toBe(texts[0]);
  });
});
