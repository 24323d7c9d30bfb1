import { toBinary } from "@bufbuild/protobuf";
import {
  type Belief,
  CellsSchema,
  type Snapshot,
  SnapshotAnswer,
} from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";
import { type Difference, differenceOf, runTime } from "../../state/selectors";
import { count } from "../format";

/** What the picture shows, and how the map differs. */
export function summaryOf(picture: Snapshot, belief: Belief | undefined, columns: number): string {
  const seen = (picture.freeCells?.row.length ?? 0) + (picture.wallCells?.row.length ?? 0);
  const cells = `It shows ${count(seen, "cell")}`;
  if (belief === undefined || columns === 0) return `${cells}.`;
  return `${cells}. ${differenceText(differenceOf(picture, belief, columns))}`;
}

function differenceText({ missing, wrong }: Difference): string {
  const parts = [
    ...(missing.length > 0 ? [`is missing ${count(missing.length, "wall")}`] : []),
    ...(wrong.length > 0 ? [`has ${count(wrong.length, "extra wall")}`] : []),
  ];
  return parts.length > 0 ? `Your map ${parts.join(" and ")}.` : "Your map agrees.";
}

/** What the cells that the picture shows take in a message, without the picture. */
export function cellsBytes({ freeCells, wallCells }: Snapshot): number {
  const sizeOf = (cells: Snapshot["freeCells"]) =>
    cells ? toBinary(CellsSchema, cells).length : 0;
  return sizeOf(freeCells) + sizeOf(wallCells);
}

/** s on the run's clock; undefined while no robot has reported. */
export function pictureAge(
  state: ConsoleState,
  picture: Snapshot | undefined,
  now: number | undefined,
): number | undefined {
  if (picture === undefined || state.robots.size === 0) return undefined;
  return Math.max(0, runTime(state, now) - picture.stamp);
}

/** State of a picture's answer. `who`: name of the person who answered; empty = nobody. */
export function answerText({ answer }: Snapshot, who: string): string {
  switch (answer) {
    case SnapshotAnswer.ANSWER_PATH:
      return `answered with a path${who && ` by ${who}`}`;
    case SnapshotAnswer.ANSWER_NOTHING_NEW:
      return `nothing new${who && `, by ${who}`}`;
    case SnapshotAnswer.ANSWER_OUTDATED:
      return "replaced by a newer picture";
    default:
      return "waiting for an answer";
  }
}

/** "north-east"; from radians, 0 = east, counter-clockwise. */
export function directionText(heading: number): string {
  const names = [
    "east",
    "north-east",
    "north",
    "north-west",
    "west",
    "south-west",
    "south",
    "south-east",
  ];
  const eighth = Math.round(heading / (Math.PI / 4));
  return names[((eighth % 8) + 8) % 8] ?? "east";
}
