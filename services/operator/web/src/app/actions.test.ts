import { create } from "@bufbuild/protobuf";
import { beforeEach, describe, expect, it } from "vitest";
import { FakeClock, FakeConnection } from "../connection/fake";
import type { Outcome } from "../connection/requests";
import {
  AttentionItemSchema,
  AttentionReason,
  DriveAction,
  Mode,
} from "../protocol/generated/console_pb";
import { type UpdateBody, updates, welcomeMessage } from "../state/fixtures";
import { defaultSettings } from "../state/settings";
import { createStore, type Store } from "../state/store";
import { Actions } from "./actions";

let store: Store;
let connection: FakeConnection;
let actions: Actions;
let clock: FakeClock;

beforeEach(() => {
  store = createStore(defaultSettings);
  connection = new FakeConnection();
  clock = new FakeClock();
  actions = new Actions(store, connection, clock);
  store.receive(welcomeMessage());
});

function receive(...bodies: UpdateBody[]): void {
  store.receive(updates(bodies));
  store.settle();
}

const picture = (sequenceNumber: bigint): UpdateBody => ({
  case: "snapshot",
  value: { robot: "r1", sequenceNumber },
});
const robot = (name: string, column = 0): UpdateBody => ({
  case: "robot",
  value: { name, world: "w1", cell: { row: 0, column } },
});

describe("next", () => {
  it("chooses the robot, shows its newest picture, centres the map, and reports it to the service", () => {
    const item = { robot: "r2", world: "w1", reason: 1, cell: { row: 3, column: 4 } };
    receive(robot("r1"), robot("r2"), { case: "attention", value: { items: [item] } });
    store.chosenSequence.value = 1n;
    actions.next();
    expect(store.chosenRobot.value).toBe("r2");
    expect(store.chosenSequence.value).toBeUndefined();
    expect(store.focus.value).toMatchObject({ cell: { row: 3, column: 4 }, counter: 1 });
    expect(connection.asked).toEqual([{ case: "select", value: { robot: "r2", reason: 1 } }]);
  });

  it("chooses the path tool where a path is the only answer", async () => {
    const asks = (reason: number) => ({ robot: "r1", world: "w1", reason });
    await actions.select(create(AttentionItemSchema, asks(AttentionReason.REASON_SNAPSHOT)));
    expect(store.tool.value).toBe("look");
    await actions.select(create(AttentionItemSchema, asks(AttentionReason.REASON_FIRST_PATH)));
    expect(store.tool.value).toBe("path");
  });

  it("skips what was answered a moment ago", async () => {
    const asks = (name: string) => ({ robot: name, world: "w1", reason: 1 });
    receive(robot("r1"), robot("r2"), {
      case: "attention",
      value: { items: [asks("r1"), asks("r2")] },
    });
    connection.outcomes = [{ kind: "refused", reason: "already answered" }];
    await actions.next();
    expect(store.chosenRobot.value).toBe("r2");
    expect(store.notices.value).toEqual([]);
  });

  it("visits each item once, then the first again", async () => {
    const asks = (name: string) => ({ robot: name, world: "w1", reason: 1 });
    receive({ case: "attention", value: { items: [asks("r1"), asks("r2"), asks("r3")] } });
    const seen: unknown[] = [];
    for (let i = 0; i < 4; i += 1) {
      await actions.next();
      seen.push(store.chosenRobot.value);
    }
    expect(seen).toEqual(["r1", "r2", "r3", "r1"]);
  });

  it("says so when all items have been answered", async () => {
    connection.outcomes = [{ kind: "refused", reason: "already answered" }];
    receive({ case: "attention", value: { items: [{ robot: "r1", world: "w1", reason: 1 }] } });
    await actions.next();
    expect(store.notices.value).toHaveLength(1);
  });

  it("says so when the queue is empty", async () => {
    await actions.next();
    expect(connection.asked).toEqual([]);
    expect(store.notices.value).toHaveLength(1);
  });
});

describe("cameras", () => {
  it("are open for two robots at most, the newest", () => {
    for (const robot of ["r1", "r2", "r3"]) actions.toggleCamera(robot);
    expect(store.cameras.value).toEqual(["r2", "r3"]);
    store.large.value = { kind: "camera", robot: "r2" };
    actions.toggleCamera("r2");
    expect([store.cameras.value, store.large.value]).toEqual([["r3"], undefined]);
  });
});

describe("looking back", () => {
  it("shows an earlier state, which accepts no commands, and then the newest again", () => {
    store.link.value = { state: "live" };
    receive({ case: "robot", value: { name: "r1", x: 1 } });
    store.history.add(store.live.value, 100);
    receive({ case: "robot", value: { name: "r1", x: 2 } });
    store.history.add(store.live.value, 110);
    actions.lookBack(105);
    expect(store.motion.value.robots.get("r1")?.x).toBe(1);
    expect([store.now.value, store.canCommand.value]).toEqual([100, false]);
    void actions.resume(["r1"]);
    void actions.drive("r1", DriveAction.DRIVE_FORWARD);
    void actions.drive("r1", DriveAction.DRIVE_STOP);
    void actions.stop(["r1"]);
    expect(connection.asked.map((body) => body.case)).toEqual(["drive", "stop"]);
    expect(connection.asked[0]?.value).toMatchObject({ action: DriveAction.DRIVE_STOP });
    receive({ case: "robot", value: { name: "r1", x: 3 } });
    expect(store.motion.value.robots.get("r1")?.x).toBe(1);
    actions.lookBack(undefined);
    expect(store.motion.value.robots.get("r1")?.x).toBe(3);
    expect([store.now.value, store.canCommand.value]).toEqual([5000, true]);
  });
});

describe("control", () => {
  it("is taken at once where nobody has it", () => {
    store.name.value = "Ann";
    actions.takeControl(["r1"]);
    expect(connection.asked[0]).toMatchObject({ case: "takeControl", value: { robots: ["r1"] } });
    expect(store.dialog.value).toBeUndefined();
  });

  it("asks a person without a name first", () => {
    actions.takeControl(["r1"]);
    expect(connection.asked).toEqual([]);
    expect(store.dialog.value).toMatchObject({ takeOver: { robots: ["r1"], from: [] } });
  });

  it("goes along with another name", async () => {
    receive({ case: "control", value: { robot: "r2", holder: "me" } });
    await actions.rename("Ann");
    expect(connection.name).toBe("Ann");
    expect(connection.asked.map((body) => body.case)).toEqual(["releaseControl", "takeControl"]);
    expect(connection.asked[1]?.value).toMatchObject({ robots: ["r2"] });
  });

  it("says what became of a question for it", async () => {
    const control = (value: object) =>
      receive({
        case: "control",
        value: { robot: "r1", holder: "bo/1", holderName: "Bo", ...value },
      });
    control({});
    await actions.askForControl(["r1"], "lunch is over");
    expect(connection.asked[0]?.value).toMatchObject({ ask: true, reason: "lunch is over" });
    control({ askedBy: "me" });
    expect(actions.control.answers(store.live.value)).toEqual([]);
    control({});
    expect(actions.control.answers(store.live.value)).toEqual(["Bo keeps control of r1."]);
    expect(actions.control.answers(store.live.value)).toEqual([]);
    await actions.askForControl(["r1"], "");
    control({ holder: "me" });
    expect(actions.control.answers(store.live.value)).toEqual(["You have control of r1 now."]);
  });

  it("needs a reason where somebody else has it", () => {
    receive({ case: "control", value: { robot: "r1", holder: "you", holderName: "Bo" } });
    actions.takeControl(["r1"]);
    expect(connection.asked).toEqual([]);
    expect(store.dialog.value).toEqual({
      kind: "take over",
      takeOver: { robots: ["r1"], from: ["Bo"] },
    });
  });

  it("says that a stop is not delivered until one is", async () => {
    let reply: (outcome: Outcome) => void = () => undefined;
    connection.request = () =>
      new Promise((done) => {
        reply = done;
      });
    const stopping = actions.stop(["r1"]);
    expect(store.undeliveredStop.value).toBeUndefined();
    clock.advance(1);
    expect(store.undeliveredStop.value).toEqual(["r1"]);
    reply({ kind: "refused", reason: "too late" });
    await stopping;
    expect(store.undeliveredStop.value).toEqual(["r1"]);
    const other = actions.stop(["r2"]);
    reply({ kind: "accepted", revision: 0 });
    await other;
    expect(store.undeliveredStop.value).toEqual(["r1"]);
    const again = actions.stop([]);
    reply({ kind: "accepted", revision: 0 });
    await again;
    expect(store.undeliveredStop.value).toBeUndefined();
  });

  it("does not resume at the start what was stopped meanwhile", async () => {
    await actions.start(["r1"]);
    expect(connection.asked.map((body) => body.case)).toEqual(["takeControl", "resume"]);
    const starting = actions.start(["r1"]);
    await actions.stop([]);
    await starting;
    expect(connection.asked.slice(2).map((body) => body.case)).toEqual(["takeControl", "stop"]);
  });

  it("stops all without naming them", async () => {
    await actions.stop([]);
    expect(connection.asked[0]).toMatchObject({ case: "stop", value: { robots: [] } });
  });
});

describe("requests", () => {
  it("that were refused show a notice", async () => {
    connection.outcome = { kind: "refused", reason: "your map is old" };
    const outcome = await actions.edit("w1", [], 3n);
    expect(outcome).toEqual({ accepted: false, reason: "your map is old" });
    const text = expect.stringContaining("your map is old");
    expect(store.notices.value).toMatchObject([{ kind: "problem", text }]);
  });

  it("are counted while pending", async () => {
    const going = actions.resume(["r1"]);
    expect(store.pending.value).toBe(1);
    await going;
    expect(store.pending.value).toBe(0);
  });

  it("to drive expire in simulation time, and are not sent late", async () => {
    receive(robot("r1"), { case: "world", value: { name: "w1", time: 40 } });
    await actions.drive("r1", DriveAction.DRIVE_FORWARD);
    expect(connection.asked[0]).toMatchObject({ case: "drive", value: { expiresAt: 41 } });
    expect(connection.options[0]).toEqual({ world: "w1", validFor: 1 });
  });

  it("to drive show why they were refused, unless another one followed", async () => {
    connection.outcome = { kind: "refused", reason: "replaced by request 2" };
    const replaced = actions.drive("r1", DriveAction.DRIVE_FORWARD);
    connection.outcome = { kind: "refused", reason: "r1 is stopped" };
    await Promise.all([replaced, actions.drive("r1", DriveAction.DRIVE_STOP)]);
    expect(store.notices.value).toMatchObject([{ text: expect.stringContaining("r1 is stopped") }]);
  });
});

describe("pictures", () => {
  beforeEach(() => receive(robot("r1"), picture(1n), picture(2n), picture(3n)));

  it("can be stepped through, and the newest stays the newest", () => {
    actions.stepPicture(1);
    expect(store.chosenPicture.value?.sequenceNumber).toBe(3n);
    actions.stepPicture(-1);
    expect(store.chosenPicture.value?.sequenceNumber).toBe(2n);
    actions.stepPicture(1);
    expect(store.chosenSequence.value).toBeUndefined();
    receive(picture(4n));
    expect(store.chosenPicture.value?.sequenceNumber).toBe(4n);
  });

  it("are answered by nothing new: only the newest, and only once it is shown", () => {
    actions.stepPicture(-1);
    actions.nothingNew();
    expect(connection.asked).toEqual([]);
    expect(store.chosenPicture.value?.sequenceNumber).toBe(3n);
    actions.nothingNew();
    expect(connection.asked).toEqual([{ case: "answer", value: { robot: "r1", snapshot: 3n } }]);
  });

  it("of a mapping task are answered whichever is shown", () => {
    store.receive(welcomeMessage({ mode: Mode.MAPPING_TASK }));
    actions.stepPicture(-1);
    actions.nothingNew();
    expect(connection.asked).toMatchObject([{ value: { snapshot: 3n } }]);
  });

  it("are answered by an edit after which the map shows what they show", async () => {
    const cells = { wallCells: { row: [0], column: [1] }, freeCells: { row: [1], column: [0] } };
    receive(
      { case: "world", value: { name: "w1", rows: 2, columns: 2 } },
      { case: "belief", value: { world: "w1", walls: new Uint8Array([0, 0, 255, 0]) } },
      { case: "snapshot", value: { robot: "r1", world: "w1", sequenceNumber: 4n, ...cells } },
    );
    const wall = { cell: { row: 0, column: 1 }, wall: true };
    const free = { cell: { row: 1, column: 0 }, wall: false };
    await actions.edit("w1", [wall], 1n);
    await actions.edit("w1", [wall, { ...free, wall: true }], 1n);
    receive({ case: "control", value: { robot: "r1", holder: "Ben/2" } });
    await actions.edit("w1", [wall, free], 1n);
    receive({ case: "control", value: { robot: "r1", holder: "" } });
    connection.outcome = { kind: "refused", reason: "an older map" };
    await actions.edit("w1", [wall, free], 1n);
    expect(connection.asked.map((request) => request.case)).toEqual([
      "edit",
      "edit",
      "edit",
      "edit",
    ]);
    connection.outcome = { kind: "accepted", revision: 2 };
    await actions.edit("w1", [wall, free], 1n);
    expect(connection.asked.at(-1)).toMatchObject({ value: { robot: "r1", snapshot: 4n } });
    store.receive(welcomeMessage({ mode: Mode.MAPPING_TASK }));
    await actions.edit("w1", [wall, free], 1n);
    expect(connection.asked.at(-1)?.case).toBe("edit");
  });

  it("that no longer exist are replaced by the newest", () => {
    actions.stepPicture(-1);
    store.receive(updates([robot("r1"), picture(1n)], 9n, true));
    store.settle();
    expect(store.chosenPicture.value?.sequenceNumber).toBe(1n);
  });

  it("that were answered are not answered again", () => {
    receive({ case: "snapshot", value: { robot: "r1", sequenceNumber: 3n, answer: 1 } });
    actions.nothingNew();
    expect(connection.asked).toEqual([]);
  });
});

describe("robots", () => {
  it("are chosen in turn, in a circle, and the map follows", () => {
    receive(robot("r1", 1), robot("r2", 2));
    expect(store.chosenRobot.value).toBe("r1");
    actions.chooseBy(1);
    expect(store.chosenRobot.value).toBe("r2");
    expect(store.focus.value?.cell).toMatchObject({ column: 2 });
    actions.chooseBy(1);
    expect(store.chosenRobot.value).toBe("r1");
  });

  it("stay chosen when others appear or need attention", () => {
    receive(robot("r2"));
    receive(robot("r1"), { case: "attention", value: { items: [{ robot: "r1" }] } });
    expect(store.chosenRobot.value).toBe("r2");
  });
});
