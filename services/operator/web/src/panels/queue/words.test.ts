import { create } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { AttentionItemSchema, AttentionReason } from "../../protocol/generated/console_pb";
import { adviceText, patienceText, reasonText } from "./words";

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
