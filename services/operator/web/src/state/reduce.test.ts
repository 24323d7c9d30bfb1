import fc from "fast-check";
import { describe, expect, it } from "vitest";
import { type ConsoleState, emptyState, mostEvents } from "./console_state";
import { message, stateOf, type UpdateBody, updates, welcomeMessage } from "./fixtures";
import { reduce } from "./reduce";
import { trailCells } from "./selectors";

const cell = (row: number, column: number) => ({ row, column });
const robot = (name: string, x = 0): UpdateBody => ({ case: "robot", value: { name, x } });
const event = (id: bigint): UpdateBody => ({ case: "event", value: { id } });
const picture = (sequenceNumber: bigint, answer = 0): UpdateBody => ({
  case: "snapshot",
  value: { robot: "r1", sequenceNumber, answer },
});

describe("updates", () => {
  it("of one message count together, the newest of a key last", () => {
    const state = stateOf(robot("r1", 1), robot("r2", 2), robot("r1", 3));
    expect([...state.robots.values()].map(({ x }) => x)).toEqual([3, 2]);
    expect(state.sequence).toBe(3n);
  });

  it("leave the state before and all other parts as they were", () => {
    const before = stateOf(robot("r1", 1), { case: "world", value: { name: "w1" } });
    const after = reduce(before, updates([robot("r1", 2)], 3n));
    expect(before.robots.get("r1")?.x).toBe(1);
    expect(after.robots.get("r1")?.x).toBe(2);
    expect(after.worlds).toBe(before.worlds);
  });

  it("with everything forget what was known, but not who we are", () => {
    const before = stateOf(robot("r1"), event(1n));
    const after = reduce(before, updates([robot("r2")], 9n, true));
    expect([...after.robots.keys()]).toEqual(["r2"]);
    expect(after.events).toEqual([]);
    expect(after.welcome).toBe(before.welcome);
    expect(after.run).toBe("run-1");
    expect(after.sequence).toBe(9n);
  });

  it("keep the highest sequence number", () => {
    const state = reduce(stateOf(robot("r1"), robot("r2")), updates([robot("r1")], 1n));
    expect(state.sequence).toBe(2n);
  });

  const keyed: [string, UpdateBody][] = [
    ["worlds", { case: "world", value: { name: "k" } }],
    ["beliefs", { case: "belief", value: { world: "k" } }],
    ["truths", { case: "truth", value: { world: "k" } }],
    ["robots", { case: "robot", value: { name: "k" } }],
    ["seen", { case: "seen", value: { robot: "k" } }],
    ["plans", { case: "plan", value: { robot: "k" } }],
    ["searches", { case: "search", value: { robot: "k" } }],
    ["predictions", { case: "prediction", value: { robot: "k" } }],
    ["guidance", { case: "guidance", value: { robot: "k" } }],
    ["goalPoses", { case: "goalPose", value: { robot: "k" } }],
    ["controls", { case: "control", value: { robot: "k" } }],
    ["services", { case: "service", value: { name: "k" } }],
  ];
  it.each(keyed)("put %s under their key", (name, body) => {
    const slice = Object.entries(stateOf(body)).find(([key]) => key === name)?.[1];
    expect(slice instanceof Map && [...slice.keys()]).toEqual(["k"]);
  });

  it.each([
    "session",
    "attention",
    "presence",
    "playback",
    "task",
  ] as const)("replace the one %s", (name) => {
    expect(stateOf({ case: name, value: {} })[name]).toBeDefined();
  });
});

describe("welcome", () => {
  it("that resumes keeps the sequence number", () => {
    const state = reduce(stateOf(robot("r1")), welcomeMessage({ resumed: true }));
    expect(state.sequence).toBe(1n);
  });

  it("that does not resume asks for everything next time too, and leaves the screen as it is", () => {
    const state = reduce(stateOf(robot("r1")), welcomeMessage({ run: "run-2" }));
    expect(state.sequence).toBe(0n);
    expect(state.run).toBe("run-2");
    expect(state.robots.size).toBe(1);
  });
});

describe("lists", () => {
  it("keep pictures in order, whatever order they come in", () => {
    const state = stateOf(picture(3n), picture(1n), picture(2n));
    expect(state.pictures.get("r1")?.map((p) => p.sequenceNumber)).toEqual([1n, 2n, 3n]);
  });

  it("replace a picture that was answered", () => {
    const state = stateOf(picture(1n), picture(2n), picture(1n, 2));
    expect(state.pictures.get("r1")?.map((p) => p.answer)).toEqual([2, 0]);
  });

  it("keep the newest events only", () => {
    const all = Array.from({ length: mostEvents + 5 }, (_, i) => event(BigInt(i)));
    const state = stateOf(...all);
    expect(state.events).toHaveLength(mostEvents);
    expect(state.events[0]?.id).toBe(5n);
  });

  it("keep one alert per id", () => {
    const alert = (id: bigint, count: number): UpdateBody => ({
      case: "alert",
      value: { id, count },
    });
    const state = stateOf(alert(1n, 1), alert(2n, 1), alert(1n, 7));
    expect(state.alerts.map(({ count }) => count)).toEqual([7, 1]);
  });
});

describe("trails", () => {
  const piece = (first: number, ...columns: number[]): UpdateBody => ({
    case: "trail",
    value: { robot: "r1", first, cells: columns.map((column) => cell(0, column)) },
  });
  const columns = (...pieces: UpdateBody[]) =>
    trailCells(stateOf(...pieces).trails.get("r1") ?? new Map()).map(({ column }) => column);

  it("join pieces in the order of their numbers", () => {
    expect(columns(piece(2, 2, 3), piece(0, 0, 1))).toEqual([0, 1, 2, 3]);
  });

  it("grow with their newest piece", () => {
    expect(columns(piece(0, 0, 1), piece(2, 2), piece(2, 2, 3))).toEqual([0, 1, 2, 3]);
  });
});

describe("frames", () => {
  it("show the newest of each robot and count as no update", () => {
    const frame = (number: bigint) => message({ case: "frame", value: { robot: "r1", number } });
    const state = reduce(reduce(stateOf(robot("r1")), frame(1n)), frame(2n));
    expect(state.frames.get("r1")?.number).toBe(2n);
    expect(state.sequence).toBe(1n);
  });
});

const name = fc.constantFrom("r1", "r2", "r3");
const id = fc.bigInt({ min: 1n, max: 6n });
const body: fc.Arbitrary<UpdateBody> = fc.oneof(
  fc.record({ case: fc.constant("robot" as const), value: fc.record({ name, x: fc.integer() }) }),
  fc.record({
    case: fc.constant("snapshot" as const),
    value: fc.record({ robot: name, sequenceNumber: id, answer: fc.nat(3) }),
  }),
  fc.record({ case: fc.constant("event" as const), value: fc.record({ id, text: fc.string() }) }),
  fc.record({
    case: fc.constant("trail" as const),
    value: fc.record({ robot: name, first: fc.nat(9) }),
  }),
);

function keysOf({ pictures, events }: ConsoleState): bigint[][] {
  const numbers = [...pictures.values()].map((all) => all.map((each) => each.sequenceNumber));
  return [...numbers, events.map((event) => event.id)];
}

it("the same updates make the same state, however they are put into messages", () => {
  fc.assert(
    fc.property(fc.array(body), fc.nat(40), (bodies, cut) => {
      const at = Math.min(cut, bodies.length);
      const first = updates(bodies.slice(0, at));
      const second = updates(bodies.slice(at), BigInt(at + 1));
      const together = reduce(emptyState, updates(bodies));
      expect(reduce(reduce(emptyState, first), second)).toEqual(together);
    }),
  );
});

it("an update that comes twice changes nothing, and lists stay in order without doubles", () => {
  fc.assert(
    fc.property(fc.array(body), body, (bodies, again) => {
      const once = reduce(emptyState, updates([...bodies, again]));
      const twice = reduce(once, updates([again], BigInt(bodies.length + 1)));
      expect(twice).toEqual(once);
      for (const keys of keysOf(twice)) {
        expect([...new Set(keys)].sort((a, b) => Number(a - b))).toEqual(keys);
      }
    }),
  );
});
