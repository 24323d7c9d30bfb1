import { create } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { AttentionItemSchema, AttentionReason, Mode, Role } from "../protocol/generated/console_pb";
import { emptyState } from "./console_state";
import { stateOf, type UpdateBody, welcomeMessage } from "./fixtures";
import { ageOf, freshnessOf } from "./freshness";
import { reduce } from "./reduce";
import {
  commandBlockedReason,
  differenceOf,
  holderOf,
  itemKey,
  mayStop,
  nameOf,
  nextItem,
  pictureOf,
  placeOf,
  robotNames,
  unanswered,
  waitingItems,
  waitsForStart,
  withNames,
  worldOf,
} from "./selectors";

const session = (...robots: string[]): UpdateBody => ({ case: "session", value: { robots } });
const control = (robot: string, holder = "", stopped = false): UpdateBody => ({
  case: "control",
  value: { robot, holder, holderName: holder && `name of ${holder}`, stopped },
});
const items = (...all: [robot: string, selectedBy: string][]): UpdateBody => ({
  case: "attention",
  value: { items: all.map(([robot, selectedBy]) => ({ robot, selectedBy })) },
});

describe("names", () => {
  const here: UpdateBody = {
    case: "presence",
    value: { people: [{ client: "x/1", name: "Zoë" }] },
  };

  it("are those of people who are or were here", () => {
    const state = stateOf(here);
    expect(nameOf(state, "me")).toBe("you");
    expect(nameOf(state, "x/1")).toBe("Zoë");
    expect(nameOf(state, "Ben/2")).toBe("Ben");
    expect(nameOf(state, "synthetic-operator-01a2176bd43c-4c91e7b4")).toBe("synthetic-operator");
  });

  it("replace client ids in texts of the service", () => {
    const client = "Ada Smith/1ba2983b720ab97d";
    const state = reduce(stateOf(here), welcomeMessage({ client }));
    expect(withNames(state, `${client} has control of r1: take over first`)).toBe(
      "you have control of r1: take over first",
    );
    expect(withNames(state, "Eve/1ba2983b720ab97e has control of all robots")).toBe(
      "Eve has control of all robots",
    );
    expect(withNames(state, "synthetic-operator-01a2176bd43c-4c91e7b4 has control")).toBe(
      "synthetic-operator has control",
    );
    expect(withNames(stateOf(), "some other reason")).toBe("some other reason");
  });
});

describe("freshness", () => {
  it.each([
    [0, "live"],
    [0.9, "live"],
    [1, "stale"],
    [2.9, "stale"],
    [3, "lost"],
  ])("after %f s is %s", (age, expected) => {
    expect(freshnessOf(100, 100 + age, true)).toBe(expected);
  });

  it("without any state is lost", () => {
    expect(freshnessOf(undefined, 5, true)).toBe("lost");
    expect(freshnessOf(0, 5, true)).toBe("lost");
    expect(freshnessOf(5, undefined, true)).toBe("lost");
  });

  it("is unknown without a link", () => {
    expect(freshnessOf(100, 100, false)).toBe("unknown");
  });

  it("tolerates clocks that differ a little", () => {
    expect(ageOf(10.1, 10)).toBe(0);
  });
});

describe("robots", () => {
  it("come in the order of the configuration, then by name", () => {
    const robot = (name: string): UpdateBody => ({ case: "robot", value: { name } });
    const state = stateOf(session("r2", "r1"), robot("r9"), robot("r1"), robot("r10"));
    expect(robotNames(state)).toEqual(["r2", "r1", "r9", "r10"]);
  });
});

describe("command", () => {
  it("is anybody's while nobody has control", () => {
    expect(commandBlockedReason(stateOf(control("r1")), "r1")).toBeUndefined();
    expect(commandBlockedReason(stateOf(), "r1")).toBeUndefined();
  });

  it("is mine while I have control", () => {
    expect(commandBlockedReason(stateOf(control("r1", "me")), "r1")).toBeUndefined();
    expect(holderOf(stateOf(control("r1", "me")), "r1").kind).toBe("me");
  });

  it("is not mine while another person, who is named, has control", () => {
    expect(commandBlockedReason(stateOf(control("r1", "you")), "r1")).toContain("name of you");
  });

  it("is no observer's, and nobody's in a recording or before the Welcome", () => {
    const observer = reduce(emptyState, welcomeMessage({ role: Role.OBSERVER }));
    const replay = reduce(emptyState, welcomeMessage({ mode: Mode.REPLAY }));
    expect(commandBlockedReason(observer, "r1")).toBeDefined();
    expect(commandBlockedReason(replay, "r1")).toBeDefined();
    expect(commandBlockedReason(emptyState, "r1")).toBeDefined();
  });
});

describe("the next item", () => {
  const none = new Set<string>();
  const key = (robot: string) => itemKey(create(AttentionItemSchema, { robot }));
  const next = (all: UpdateBody, passed = none, gone = none) =>
    nextItem(stateOf(all), passed, gone)?.robot;

  it("is the first that waits", () => {
    expect(next(items(["r2", ""], ["r1", ""]))).toBe("r1");
  });

  it("is the first that was not passed", () => {
    const all = items(["r2", ""], ["r1", "me"], ["r3", ""]);
    expect(next(all, new Set([key("r2"), key("r1")]))).toBe("r3");
  });

  it("is another one than mine when all were passed, and stays when there is no other", () => {
    const passed = new Set([key("r1"), key("r2")]);
    expect(next(items(["r2", "me"], ["r1", ""]), passed)).toBe("r1");
    expect(next(items(["r2", "me"]), passed)).toBe("r2");
  });

  it("leaves out what somebody else works on, and what is done", () => {
    expect(next(items(["r2", "you"], ["r1", ""]))).toBe("r1");
    expect(next(items(["r2", "you"]))).toBeUndefined();
    expect(next(items(["r2", ""], ["r1", ""]), none, new Set([key("r2")]))).toBe("r1");
  });
});

describe("pictures", () => {
  const picture = (sequenceNumber: bigint, answer: number): UpdateBody => ({
    case: "snapshot",
    value: { robot: "r1", sequenceNumber, answer },
  });

  it("are found by their number, without one the newest", () => {
    const state = stateOf(picture(1n, 0), picture(2n, 0));
    expect(pictureOf(state, "r1", 1n)?.sequenceNumber).toBe(1n);
    expect(pictureOf(state, "r1")?.sequenceNumber).toBe(2n);
    expect(pictureOf(state, "r1", 3n)).toBeUndefined();
    expect(pictureOf(state, undefined)).toBeUndefined();
  });

  it("only the newest can be waiting", () => {
    expect(unanswered(stateOf(picture(1n, 0), picture(2n, 0)), "r1")?.sequenceNumber).toBe(2n);
    expect(unanswered(stateOf(picture(1n, 0), picture(2n, 1)), "r1")).toBeUndefined();
    expect(unanswered(stateOf(), undefined)).toBeUndefined();
  });

  it("differ from the map in missing and wrong walls", () => {
    const cells = { wallCells: { row: [0], column: [1] }, freeCells: { row: [1], column: [0] } };
    const state = stateOf(
      { case: "snapshot", value: { robot: "r1", ...cells } },
      { case: "belief", value: { world: "w1", walls: new Uint8Array([0, 127, 128, 0]) } },
    );
    const shown = state.pictures.get("r1")?.[0];
    const belief = state.beliefs.get("w1");
    if (!shown || !belief) throw new Error("no picture, or no map");
    const { missing, wrong } = differenceOf(shown, belief, 2);
    expect([missing, wrong]).toMatchObject([[{ row: 0, column: 1 }], [{ row: 1, column: 0 }]]);
  });
});

describe("a robot's own", () => {
  const world = (name: string): UpdateBody => ({ case: "world", value: { name } });
  const robot = (name: string, at: string): UpdateBody => ({
    case: "robot",
    value: { name, world: at },
  });

  it("world is the one it is in, or the first while it has no state", () => {
    const state = stateOf(world("w1"), world("w2"), robot("r2", "w2"));
    expect(worldOf(state, "r2")?.name).toBe("w2");
    expect(worldOf(state, "r9")?.name).toBe("w1");
    const named: UpdateBody = { case: "session", value: { worlds: ["w2", "w1"] } };
    expect(worldOf(stateOf(world("w1"), world("w2"), named), undefined)?.name).toBe("w2");
  });
});

describe("what robots wait for", () => {
  const { REASON_SNAPSHOT, REASON_FIRST_PATH, REASON_BLOCKED, REASON_GOALS_REACHED } =
    AttentionReason;
  type Item = { robot: string; reason: AttentionReason; deadline?: number; givesUpAfter?: number };
  const waiting = (all: Item[], ...more: UpdateBody[]) =>
    waitingItems(stateOf(...more, { case: "attention", value: { items: all } })).map(
      ({ robot, reason }) => [robot, reason],
    );

  it("is one item for each robot, the service's first, by deadline and then by name", () => {
    expect(
      waiting([
        { robot: "r10", reason: REASON_BLOCKED },
        { robot: "r3", reason: REASON_GOALS_REACHED },
        { robot: "r2", reason: REASON_BLOCKED },
        { robot: "r1", reason: REASON_SNAPSHOT, deadline: 40 },
        { robot: "r4", reason: REASON_SNAPSHOT, deadline: 30 },
        { robot: "r4", reason: REASON_BLOCKED },
      ]),
    ).toEqual([
      ["r4", REASON_SNAPSHOT],
      ["r1", REASON_SNAPSHOT],
      ["r2", REASON_BLOCKED],
      ["r10", REASON_BLOCKED],
    ]);
    const first = { robot: "r1", reason: REASON_FIRST_PATH };
    const picture = { robot: "r1", reason: REASON_SNAPSHOT, deadline: 40 };
    expect(waiting([first, picture])).toEqual([["r1", REASON_SNAPSHOT]]);
  });

  it("is not a path for a robot that drives by itself without one", () => {
    const method = (name: string): UpdateBody => ({ case: "session", value: { method: name } });
    const moved: UpdateBody = { case: "robot", value: { name: "r1", cellMoves: 3n } };
    const all = [{ robot: "r1", reason: REASON_FIRST_PATH }];
    expect(waiting(all, method("ig-mcts"), moved)).toEqual([]);
    expect(waiting(all, method("ig-mcts"))).toHaveLength(1);
    expect(waiting(all, method("instruction"), moved)).toHaveLength(1);
  });
});

it("everybody who is connected can stop robots, but not in a recording", () => {
  expect(mayStop(reduce(emptyState, welcomeMessage({ role: Role.OBSERVER })))).toBe(true);
  expect(mayStop(reduce(emptyState, welcomeMessage({ mode: Mode.REPLAY })))).toBe(false);
});

describe("the start", () => {
  it("waits while all robots are stopped and nobody has control", () => {
    const all = [session("r1", "r2"), control("r1", "", true)];
    expect(waitsForStart(stateOf(...all, control("r2", "", true)))).toBe(true);
    expect(waitsForStart(stateOf(...all, control("r2", "", false)))).toBe(false);
    expect(waitsForStart(stateOf(...all, control("r2", "you", true)))).toBe(false);
    expect(waitsForStart(stateOf(...all))).toBe(false);
    expect(waitsForStart(stateOf())).toBe(false);
  });
});

describe("alerts", () => {
  const alert = (value: Extract<UpdateBody, { case: "alert" }>["value"]) => {
    const found = stateOf({ case: "alert", value }).alerts[0];
    if (!found) throw new Error("no alert");
    return placeOf(found, 100);
  };

  it("are active, shelved, acknowledged or over", () => {
    expect(alert({ id: 1n, active: true })).toBe("active");
    expect(alert({ id: 1n, active: false })).toBe("over");
    expect(alert({ id: 1n, active: true, acknowledgedBy: "me" })).toBe("acknowledged");
    expect(alert({ id: 1n, active: false, acknowledgedBy: "me" })).toBe("over");
    expect(alert({ id: 1n, active: true, shelvedUntil: 101 })).toBe("shelved");
    expect(alert({ id: 1n, active: true, shelvedUntil: 99 })).toBe("active");
  });
});
