import { create } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { type Event, EventKind, EventSchema } from "../../protocol/generated/console_pb";
import { logLines } from "./command_log";

const event = (id: bigint, time: number, text: string, kind = EventKind.EVENT_REFUSED): Event =>
  create(EventSchema, { id, time, text, kind, client: "sim", robot: "r1" });

const lines = (...events: Event[]) =>
  logLines(events).map(({ event: { id }, times, since }) => [id, times, since]);

describe("the command log", () => {
  it("folds a refusal that repeats, also with something else in between", () => {
    const go = event(3n, 13, "resumed r1", EventKind.EVENT_RESUME);
    const refused = (id: bigint, time: number, cells: number) =>
      event(id, time, `refused (drew a path of ${cells} cells): Ada has control`);
    expect(lines(refused(1n, 10, 18), refused(2n, 12, 17), go, refused(4n, 15, 18))).toEqual([
      [4n, 3, 10],
      [3n, 1, 13],
    ]);
  });

  it("keeps apart what is of another reason, robot or time, and what was done", () => {
    expect(lines(event(1n, 1, "a"), event(2n, 2, "b"))).toHaveLength(2);
    expect(lines(event(1n, 1, "a"), { ...event(2n, 2, "a"), robot: "r2" })).toHaveLength(2);
    expect(lines(event(1n, 1, "a"), event(2n, 100, "a"))).toEqual([
      [2n, 1, 100],
      [1n, 1, 1],
    ]);
    const go = (id: bigint) => event(id, 1, "resumed r1", EventKind.EVENT_RESUME);
    expect(lines(go(1n), go(2n))).toHaveLength(2);
  });
});
