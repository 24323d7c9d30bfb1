import { create } from "@bufbuild/protobuf";
import { beforeEach, describe, expect, it, vi } from "vitest";
import { type Snapshot, SnapshotAnswer, SnapshotSchema } from "../../protocol/generated/console_pb";
import { namedPalette, RecordingContext } from "../draw/recording";
import type { View } from "../view";
import { PictureMarks } from "./pictures";

const view: View = { scale: 4, x: 0, y: 0, width: 100, height: 50 };

let kept: RecordingContext;

beforeEach(() => {
  kept = new RecordingContext();
  const context = Object.assign(kept, { setTransform: () => undefined });
  const canvas = { width: 0, height: 0, getContext: () => context };
  vi.stubGlobal("document", { createElement: () => canvas });
  vi.stubGlobal("devicePixelRatio", 1);
});

function picture(sequence: number, answer = SnapshotAnswer.ANSWER_PATH): Snapshot {
  const cell = { row: 1, column: sequence };
  return create(SnapshotSchema, { robot: "r1", sequenceNumber: BigInt(sequence), cell, answer });
}

function marks({ calls }: RecordingContext): number {
  return calls.filter(({ name }) => name === "fill").length;
}

/** How many marks were drawn in one frame: those that are kept, and those of this frame alone. */
function draw(on: PictureMarks, pictures: readonly Snapshot[]): [number, number] {
  const before = marks(kept);
  const onto = new RecordingContext();
  on.draw(onto, view, { robots: [], pictures }, namedPalette);
  return [marks(kept) - before, marks(onto)];
}

/** After a first frame: while the view moves nothing is kept. */
function inPlace(): PictureMarks {
  const all = new PictureMarks();
  draw(all, []);
  return all;
}

describe("the marks of pictures", () => {
  it("are each drawn once when they were answered, in each frame while they wait", () => {
    const all = inPlace();
    const [one, two] = [picture(1), picture(2)];
    const waiting = picture(3, SnapshotAnswer.ANSWER_NONE);
    expect(draw(all, [one, waiting])).toEqual([1, 1]);
    expect(draw(all, [one, waiting])).toEqual([0, 1]);
    expect(draw(all, [one, two, waiting])).toEqual([1, 1]);
    expect(draw(all, [one, two, picture(3)])).toEqual([1, 0]);
  });

  it("are redrawn when more than a tenth of them was dropped", () => {
    const all = inPlace();
    const pictures = Array.from({ length: 20 }, (_, i) => picture(i));
    expect(draw(all, pictures)).toEqual([20, 0]);
    expect(draw(all, pictures.slice(1))).toEqual([0, 0]);
    expect(draw(all, pictures.slice(2))).toEqual([18, 0]);
    expect(draw(all, [])).toEqual([0, 0]);
    expect(draw(all, pictures)).toEqual([20, 0]);
  });
});
