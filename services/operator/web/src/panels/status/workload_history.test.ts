import { create } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { AttentionSchema } from "../../protocol/generated/console_pb";
import { emptyHistory, loadLevel, mostSamples, withSample } from "./workload_history";

const at = (stamp: number, more = {}) => create(AttentionSchema, { stamp, observed: 1, ...more });

describe("history", () => {
  it("takes one sample a second", () => {
    const first = withSample(emptyHistory, at(10, { utilisation: 0.5, attendedRobots: 2 }));
    expect(withSample(first, at(10.5))).toBe(first);
    const second = withSample(first, at(11, { items: [{}, { selectedBy: "me" }] }));
    expect(second).toEqual({
      time: [10, 11],
      utilisation: [0.5, 0],
      fanOut: [2, 0],
      waiting: [0, 1],
    });
  });

  it("has no values while nothing was measured", () => {
    expect(withSample(emptyHistory, at(0, { observed: 0 })).utilisation).toEqual([undefined]);
  });

  it("starts over when time runs backwards", () => {
    expect(withSample(withSample(emptyHistory, at(10)), at(3)).time).toEqual([3]);
  });

  it("keeps the newest samples", () => {
    let history = emptyHistory;
    for (let t = 0; t < mostSamples + 3; t += 1) history = withSample(history, at(t));
    expect(history.time).toHaveLength(mostSamples);
    expect(history.time[0]).toBe(3);
  });
});

describe("load", () => {
  it.each([
    [0.7, "calm"],
    [0.71, "busy"],
    [0.86, "overloaded"],
  ])("of %f is %s", (utilisation, level) => {
    expect(loadLevel(utilisation)).toBe(level);
  });
});
