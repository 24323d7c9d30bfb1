import { beforeEach, describe, expect, it } from "vitest";
import { FakeClock, FakeConnection } from "../connection/fake";
import { Role } from "../protocol/generated/console_pb";
import { type UpdateBody, updates, welcomeMessage } from "../state/fixtures";
import { defaultSettings } from "../state/settings";
import { createStore, type Store } from "../state/store";
import { Actions } from "./actions";
import { mapView } from "./map_view";

const world = (name: string): UpdateBody => ({
  case: "world",
  value: { name, rows: 2, columns: 2 },
});
const robot = (name: string, at = "w1"): UpdateBody => ({
  case: "robot",
  value: { name, world: at },
});
const plan = (name: string): UpdateBody => ({ case: "plan", value: { robot: name } });

let store: Store;
let connection: FakeConnection;
let view: ReturnType<typeof mapView>;

beforeEach(() => {
  store = createStore(defaultSettings);
  connection = new FakeConnection();
  view = mapView(store, new Actions(store, connection, new FakeClock()));
});

function receive(...bodies: UpdateBody[]): void {
  store.receive(updates(bodies));
}

describe("the map's view", () => {
  it("is none until a world is known", () => {
    expect(view.value).toBeUndefined();
    receive(world("w1"));
    expect(view.value?.world.name).toBe("w1");
  });

  it("shows the world of the chosen robot only", () => {
    receive(world("w1"), world("w2"), robot("r1"), robot("r2", "w2"), plan("r1"), plan("r2"));
    store.choose("r2");
    expect(view.value?.world.name).toBe("w2");
    expect(view.value?.robots.map((each) => each.robot.name)).toEqual(["r2"]);
    expect([...(view.value?.plans.keys() ?? [])]).toEqual(["r2"]);
  });

  it("keeps what did not change as the same objects", () => {
    receive(world("w1"), robot("r1"), plan("r1"), { case: "trail", value: { robot: "r1" } });
    const before = view.value;
    receive(robot("r1"));
    expect(view.value?.robots).not.toBe(before?.robots);
    expect(view.value?.plans).toBe(before?.plans);
    expect(view.value?.trails).toBe(before?.trails);
    expect(view.value?.pictures).toBe(before?.pictures);
  });

  it("shows no robot as live while the link is down", () => {
    receive(world("w1"), { case: "robot", value: { name: "r1", world: "w1", receivedAt: 99.9 } });
    store.now.value = 100;
    store.link.value = { state: "live" };
    expect(view.value?.robots[0]?.fresh).toBe("live");
    store.link.value = { state: "lost", attempt: 1, retryAt: 0 };
    expect(view.value?.robots[0]?.fresh).toBe("unknown");
  });

  it("gives a robot its look by its place in the configuration", () => {
    receive(
      { case: "session", value: { robots: ["r2", "r1"] } },
      world("w1"),
      robot("r1"),
      robot("r2"),
    );
    expect(view.value?.robots.map((each) => each.letter)).toEqual(["A", "B"]);
  });

  it("forbids changes while the connection is not live, with the reason", () => {
    store.receive(welcomeMessage());
    receive(world("w1"), robot("r1"));
    expect(view.value?.mayEdit).toMatchObject({ allowed: false });
    store.link.value = { state: "live" };
    expect(view.value?.mayEdit).toEqual({ allowed: true });
    expect(view.value?.mayGuide).toEqual({ allowed: true });
  });

  it("has no tools for observers", () => {
    receive(world("w1"), robot("r1"));
    store.link.value = { state: "live" };
    store.receive(welcomeMessage({ role: Role.OBSERVER }));
    expect(view.value?.readOnly).toBe(true);
    view.value?.onTool("wall");
    expect(store.tool.value).toBe("look");
    store.link.value = { state: "stale", since: 0 };
    expect(view.value?.readOnly).toBe(true);
    store.receive(welcomeMessage({ role: Role.OPERATOR }));
    expect(view.value?.readOnly).toBe(false);
    view.value?.onTool("wall");
    expect(store.tool.value).toBe("wall");
  });

  it("forbids guiding a robot that somebody else controls, but not editing the map", () => {
    store.receive(welcomeMessage());
    store.link.value = { state: "live" };
    receive(world("w1"), robot("r1"), { case: "control", value: { robot: "r1", holder: "you" } });
    expect(view.value?.mayEdit.allowed).toBe(true);
    expect(view.value?.mayGuide.allowed).toBe(false);
  });

  it("answers the newest picture by a path", async () => {
    store.receive(welcomeMessage());
    receive(world("w1"), robot("r1"), {
      case: "snapshot",
      value: { robot: "r1", sequenceNumber: 7n },
    });
    await view.value?.onPath("r1", [{ row: 1, column: 1 }]);
    expect(connection.asked[0]).toMatchObject({
      case: "guide",
      value: { robot: "r1", answersSnapshot: 7n, validFor: 600 },
    });
  });

  it("answers no picture by withdrawing a path", async () => {
    store.receive(welcomeMessage());
    receive(world("w1"), robot("r1"), {
      case: "snapshot",
      value: { robot: "r1", sequenceNumber: 7n },
    });
    await view.value?.onPath("r1", []);
    expect(connection.asked[0]).toMatchObject({ value: { path: [], answersSnapshot: 0n } });
  });

  it("sends an edit to the world that it was drawn in, whichever is shown now", async () => {
    receive(world("w1"), world("w2"), robot("r1"), robot("r2", "w2"));
    const drawn = view.value;
    store.choose("r2");
    await drawn?.onEdit("w1", [], 0n);
    expect(connection.options[0]).toMatchObject({ world: "w1" });
  });
});
