import { create } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { BeliefSchema, SnapshotAnswer, SnapshotSchema } from "../../protocol/generated/console_pb";
import { answerText, cellsBytes, directionText, summaryOf } from "./summary";

const belief = create(BeliefSchema, { walls: new Uint8Array([255, 0, 0, 255]) });
const cells = (...at: [number, number][]) => ({
  row: at.map(([row]) => row),
  column: at.map(([, column]) => column),
});

describe("a picture's summary", () => {
  it("counts missing and extra walls of the map", () => {
    const picture = create(SnapshotSchema, {
      wallCells: cells([0, 1]),
      freeCells: cells([0, 0], [1, 1]),
    });
    expect(summaryOf(picture, belief, 2)).toMatch(/3 cells.*1 wall .*2 extra walls/);
  });

  it("knows what its cells take without the picture", () => {
    const picture = (...free: [number, number][]) =>
      create(SnapshotSchema, { freeCells: cells(...free), bytes: 10_000 });
    const [few, more] = [picture([1, 1]), picture([1, 1], [1, 2], [1, 3])].map(cellsBytes);
    expect(few).toBeGreaterThan(0);
    expect(more).toBe((few ?? 0) + 4);
  });

  it("says when the map agrees, and does not mention the map where there is none", () => {
    const picture = create(SnapshotSchema, { wallCells: cells([0, 0]), freeCells: cells([0, 1]) });
    expect(summaryOf(picture, belief, 2)).toMatch(/2 cells.*map/);
    expect(summaryOf(picture, belief, 2)).not.toMatch(/wall/);
    expect(summaryOf(picture, undefined, 2)).not.toMatch(/map/);
  });

  it("names who answered", () => {
    const answer = SnapshotAnswer.ANSWER_NOTHING_NEW;
    expect(answerText(create(SnapshotSchema, { answer }), "you")).toContain("by you");
    expect(answerText(create(SnapshotSchema, { answer }), "")).not.toContain("by");
  });
});

describe("directions", () => {
  it.each([
    [0, "east"],
    [Math.PI / 2, "north"],
    [-Math.PI / 2, "south"],
    [Math.PI, "west"],
    [7.07, "north-east"],
    [-0.8, "south-east"],
  ])("of %f is %s", (heading, name) => {
    expect(directionText(heading)).toBe(name);
  });
});
