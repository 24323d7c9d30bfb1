import { beforeEach, describe, expect, it } from "vitest";
import { FakeClock, FakeConnection } from "../connection/fake";
import { Announcer } from "../panels/attention/announcer";
import { AttentionReason, Mode, Severity, TaskKind } from "../protocol/generated/console_pb";
import { type UpdateBody, updates, welcomeMessage } from "../state/fixtures";
import { defaultSettings } from "../state/settings";
import { createStore, type Store } from "../state/store";
import { Actions } from "./actions";
import {
  announceReconnect,
  callForAttention,
  followWords,
  notifyControlLoss,
  offerStart,
  reportUse,
} from "./wire";
import { setWords } from "./words";

let store: Store;

beforeEach(() => {
  store = createStore(defaultSettings);
});

describe("the link", () => {
  it("is announced when it comes back, not when it comes first", () => {
    const announcer = new Announcer(new FakeClock());
    announceReconnect(store, announcer);
    store.receive(welcomeMessage());
    store.link.value = { state: "live" };
    expect(announcer.polite.value).toBe("");
    store.link.value = { state: "lost", attempt: 1, retryAt: 0 };
    store.link.value = { state: "connecting" };
    expect(announcer.polite.value).toBe("");
    store.link.value = { state: "live" };
    expect(announcer.polite.value).not.toBe("");
  });
});

describe("the tab", () => {
  it("says what is urgent first, and is heard once for it", () => {
    let beeps = 0;
    const page = { title: "" };
    callForAttention(store, page, () => {
      beeps += 1;
    });
    store.link.value = { state: "live" };
    store.receive(welcomeMessage());
    expect(page.title).toBe("conav console");
    const reason = AttentionReason.REASON_BLOCKED;
    const waits: UpdateBody = { case: "attention", value: { items: [{ robot: "r1", reason }] } };
    store.receive(updates([waits]));
    expect([page.title, beeps]).toEqual(["(1) conav console", 0]);
    const alarm = { id: 1n, severity: Severity.ALARM, active: true, source: "disk" };
    store.receive(updates([{ case: "alert", value: alarm }], 2n));
    store.receive(updates([waits], 3n));
    expect([page.title, beeps]).toEqual(["▲ disk · conav console", 1]);
    store.settings.value = { ...store.settings.value, sound: false };
    store.undeliveredStop.value = [];
    expect([page.title, beeps]).toEqual(["STOP NOT DELIVERED · conav console", 1]);
  });
});

it("a participant's tab has the step's title, in the page's words", () => {
  const page = { title: "" };
  followWords(store);
  callForAttention(store, page, () => undefined);
  store.link.value = { state: "live" };
  const words = { "Part {} of {}": "Teil {} von {}" };
  const task: UpdateBody = {
    case: "task",
    value: { kind: TaskKind.TASK_STUDY, number: 2, count: 9, words },
  };
  store.receive(welcomeMessage({ mode: Mode.STUDY }), updates([task]));
  expect(page.title).toBe("Teil 2 von 9");
  setWords({});
});

describe("control that is lost", () => {
  it("shows a notice until it is dismissed, also after a restart of the service", () => {
    const connection = new FakeConnection();
    const actions = new Actions(store, connection, new FakeClock());
    const held = (holder: string): UpdateBody => ({
      case: "control",
      value: { robot: "r1", holder, heldUntil: (connection.serviceTime() ?? 0) + 30 },
    });
    notifyControlLoss(store, actions, connection);
    store.receive(welcomeMessage({ client: "me" }));
    store.receive(updates([held("me")]));
    store.receive(welcomeMessage({ client: "me", run: "run-2" }));
    expect(store.notices.value).toEqual([]);
    store.receive(updates([held("")]));
    for (const other of ["a", "b", "c", "d", "e"]) actions.notify(other);
    expect(store.notices.value.map(({ text }) => text)).toEqual([
      expect.stringContaining("r1"),
      "c",
      "d",
      "e",
    ]);
  });
});

describe("use of the page", () => {
  it("is reported for every kind of input", () => {
    const connection = new FakeConnection();
    const page = new EventTarget();
    reportUse(connection, page);
    for (const kind of ["pointermove", "keydown", "wheel"]) page.dispatchEvent(new Event(kind));
    expect(connection.uses).toBe(3);
  });
});

describe("the offer to begin", () => {
  const control = (stopped: boolean): UpdateBody => ({
    case: "control",
    value: { robot: "r1", stopped },
  });
  const receive = (...bodies: UpdateBody[]) =>
    store.receive(updates([{ case: "session", value: { robots: ["r1"] } }, ...bodies]));

  beforeEach(() => {
    store.receive(welcomeMessage());
    offerStart(store);
    receive(control(true));
  });

  it("is made once per run", () => {
    expect(store.dialog.value).toEqual({ kind: "start" });
    store.dialog.value = undefined;
    receive(control(true));
    expect(store.dialog.value).toBeUndefined();
    store.receive(welcomeMessage({ run: "run-2" }));
    expect(store.dialog.value).toEqual({ kind: "start" });
  });

  it("comes with the next step of a study, whose help ends with the step", () => {
    const task = (step: string): UpdateBody => ({ case: "task", value: { step } });
    receive(control(false), task("maze-1"));
    store.dialog.value = { kind: "help" };
    store.tool.value = "wall";
    receive(task("maze-1"));
    expect(store.tool.value).toBe("wall");
    expect(store.dialog.value).toEqual({ kind: "help" });
    receive(task("trust"));
    expect(store.dialog.value).toBeUndefined();
    expect(store.tool.value).toBe("look");
    store.receive(welcomeMessage({ run: "run-2" }));
    receive(control(true));
    receive(task("maze-2"));
    expect(store.dialog.value).toEqual({ kind: "start" });
  });

  it("ends when somebody begins elsewhere", () => {
    receive(control(false));
    expect(store.dialog.value).toBeUndefined();
  });
});
