import { create } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { BeliefSchema, PictureAnswer, PictureSchema } from "../../protocol/generated/console_pb";
import { answerText, directionText, summaryOf } from "./summary";

const belief = create(BeliefSchema, { walls: new Uint8Array([255, 0, 0, 255]) });
const cells = (...at: [number, number][]) => ({
  row: at.map(([row]) => row),
  column: at.map(([, column]) => column),
});

describe("a picture's summary", () => {
  it("tells what the map lacks and has too many", () => {
    const picture = create(PictureSchema, {
      wallCells: cells([0, 1]),
      freeCells: cells([0, 0], [1, 1]),
    });
    expect(summaryOf(picture, belief, 2)).toBe(
      "It shows 3 cells. Your map lacks 1 wall and has 2 walls too many.",
    );
  });

  it("says when the map agrees, and nothing of the map where there is none", () => {
    const picture = create(PictureSchema, { wallCells: cells([0, 0]), freeCells: cells([0, 1]) });
    expect(summaryOf(picture, belief, 2)).toBe("It shows 2 cells. Your map agrees with it.");
    expect(summaryOf(picture, undefined, 2)).toBe("It shows 2 cells.");
  });

  it("tells who answered, and that it waits", () => {
    const answer = PictureAnswer.ANSWER_NOTHING_NEW;
    expect(answerText(create(PictureSchema, { answer }), "you")).toBe("nothing new, by you");
    expect(answerText(create(PictureSchema), "")).toBe("waits for an answer");
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
