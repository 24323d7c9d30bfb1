import { beforeEach, describe, expect, it } from "vitest";
import type { ServerMessage } from "../protocol/generated/console_pb";
import type { Known, Link } from "./connection";
import { FakeClock, FakeService } from "./fake";
import { ServiceConnection } from "./service_connection";
import type { Timing } from "./timing";

const welcome = {
  case: "welcome",
  value: { run: "run-1", client: "page-1", serviceTime: 9000 },
} as const;
const stop = { case: "stop", value: { reason: "test" } } as const;

let clock: FakeClock;
let service: FakeService;
let links: Link[];
let messages: ServerMessage[];
let timing: Timing | undefined;
let known: Known;
let connection: ServiceConnection;

beforeEach(() => {
  clock = new FakeClock();
  service = new FakeService();
  links = [];
  messages = [];
  known = { run: "", sequence: 0n };
  connection = new ServiceConnection({
    sockets: service.factory,
    clock,
    identity: {
      token: "secret",
      name: "Ada",
      instance: "0123456789abcdef",
      isNamed: false,
      experimenter: false,
      idsAbove: 0n,
    },
    known: () => known,
    events: {
      linkChanged: (link) => links.push(link),
      received: (message) => messages.push(message),
      timingChanged: (now) => {
        timing = now;
      },
    },
  });
  connection.start();
});

function goLive(): void {
  service.newest.open();
  service.newest.say(welcome);
}

/** The service answers every ping so late; advances by it. */
function pong(after: number, serviceTime: number): void {
  const ping = service.newest.ofCase("ping").at(-1)?.body;
  if (ping?.case !== "ping") throw new Error("no ping");
  clock.advance(after);
  service.newest.say({ case: "pong", value: { pageTime: ping.value.pageTime, serviceTime } });
}

describe("what was taken", () => {
  const updates = { case: "updates", value: {} } as const;
  const frame = { case: "frame", value: { robot: "r1" } } as const;
  const taken = () =>
    service.newest.ofCase("taken").map(({ body }) => body.case === "taken" && body.value.messages);

  it("is announced in Hello, and reported when it is shown", () => {
    goLive();
    expect(service.newest.sent[0]?.body.value).toMatchObject({ saysTaken: true });
    service.newest.say(updates);
    service.newest.say(frame);
    expect(taken()).toEqual([]);
    connection.shown();
    service.newest.say(updates);
    connection.shown();
    expect(taken()).toEqual([2n, 3n]);
  });

  it("is reported once, and only for updates and frames", () => {
    goLive();
    connection.shown();
    pong(0.1, 9000);
    connection.shown();
    expect(taken()).toEqual([]);
    service.newest.say(updates);
    connection.shown();
    connection.shown();
    expect(taken()).toEqual([1n]);
  });

  it("is counted from zero with each connection", () => {
    goLive();
    service.newest.say(updates);
    service.newest.break();
    connection.shown();
    clock.advance(30);
    goLive();
    connection.shown();
    service.newest.say(updates);
    connection.shown();
    expect(taken()).toEqual([1n]);
  });
});

describe("Hello", () => {
  it("comes first and says who the page is and what it knows", () => {
    known = { run: "run-0", sequence: 17n };
    service.newest.open();
    expect(service.newest.sent[0]?.body.value).toMatchObject({
      token: "secret",
      name: "Ada",
      instance: "0123456789abcdef",
      run: "run-0",
      sequence: 17n,
    });
  });

  it("makes the link live once the Welcome arrives", () => {
    service.newest.open();
    expect(connection.link.state).toBe("connecting");
    service.newest.say(welcome);
    expect(connection.link.state).toBe("live");
    expect(messages[0]?.body.case).toBe("welcome");
  });

  it("closes a connection that never answers", () => {
    service.newest.open();
    clock.advance(6.5);
    expect(links.map(({ state }) => state)).toContain("lost");
    expect(service.sockets[0]?.closed).toBe(true);
  });
});

describe("silence", () => {
  it("is stale after 1.5 s without a message and live again with the next", () => {
    goLive();
    clock.advance(1.25);
    expect(connection.link.state).toBe("live");
    clock.advance(0.5);
    expect(connection.link.state).toBe("stale");
    pong(0, 9001);
    expect(connection.link.state).toBe("live");
  });

  it("comes back with backoff after the socket closed", () => {
    goLive();
    service.newest.break();
    expect(connection.link).toEqual({ state: "lost", attempt: 1, retryAt: clock.time + 0.25 });
    clock.advance(0.25);
    expect(service.sockets).toHaveLength(2);
    service.newest.break();
    expect(connection.link).toEqual({ state: "lost", attempt: 2, retryAt: clock.time + 0.375 });
  });

  it("waits 4 s at most, and starts over after a Welcome", () => {
    for (let i = 0; i < 8; i += 1) {
      service.newest.break();
      clock.advance(4);
    }
    const { link } = connection;
    expect(link.state).toBe("connecting");
    goLive();
    service.newest.break();
    expect(connection.link).toMatchObject({ attempt: 1 });
  });

  it("ignores a socket that it closed", () => {
    goLive();
    const old = service.newest;
    old.break();
    clock.advance(0.25);
    goLive();
    old.break();
    expect(connection.link.state).toBe("live");
  });
});

describe("Goodbye", () => {
  it("stays closed when the service says so, with its reason", () => {
    goLive();
    service.newest.say({ case: "goodbye", value: { reason: "wrong token", retry: false } });
    expect(connection.link).toEqual({ state: "closed", reason: "wrong token" });
    clock.advance(60);
    expect(service.sockets).toHaveLength(1);
  });

  it("comes back when the service says so", () => {
    goLive();
    service.newest.say({ case: "goodbye", value: { reason: "too slow", retry: true } });
    clock.advance(0.5);
    expect(service.sockets).toHaveLength(2);
  });
});

describe("pings", () => {
  it("go twice a second with the round trip of the one before", () => {
    goLive();
    pong(0.1, 9000.05);
    clock.advance(0.9);
    const pings = service.newest.ofCase("ping").map(({ body }) => body.value);
    expect(pings).toHaveLength(3);
    expect(pings[0]).toMatchObject({ measuredRoundTrip: 0 });
    expect(pings[1]).toMatchObject({ measuredRoundTrip: expect.closeTo(0.1, 9) });
  });

  it("report activity from time to time", () => {
    goLive();
    const reports = () =>
      service.newest.ofCase("ping").filter(({ body }) => body.case === "ping" && body.value.active);
    clock.advance(1);
    expect(reports()).toHaveLength(0);
    for (let second = 0; second < 9; ++second) {
      connection.used();
      pong(0.1, 9000.05);
      clock.advance(0.9);
    }
    expect(reports()).toHaveLength(2);
  });

  it("take the clock offset from the quickest of the newest round trips", () => {
    goLive();
    pong(0.1, 5000.05);
    expect(timing?.clockOffset).toBeCloseTo(4000, 6);
    clock.advance(0.4);
    pong(0.4, 5000.85); // slow to go, quick to come back
    expect(timing?.clockOffset).toBeCloseTo(4000, 6);
    expect(timing?.roundTrip).toBeCloseTo(0.4, 6);
  });

  it("count the time that the oldest unanswered one is under way", () => {
    goLive();
    pong(0.05, 9000);
    clock.advance(1.2);
    expect(timing?.roundTrip).toBeGreaterThan(0.5);
  });
});

describe("requests", () => {
  it("are refused before the service's time is known", async () => {
    expect(await connection.request(stop)).toMatchObject({ kind: "not sent" });
  });

  it("resolve with the reply of the same id", async () => {
    goLive();
    const outcome = connection.request(stop, { world: "w1" });
    expect(service.newest.requests()[0]).toMatchObject({ id: 1n, world: "w1", validUntil: 9005 });
    service.newest.say({ case: "reply", value: { id: 1n, accepted: true, revision: 4n } });
    expect(await outcome).toEqual({ kind: "accepted", revision: 4 });
  });

  it("return why they were refused", async () => {
    goLive();
    const outcome = connection.request(stop);
    service.newest.say({ case: "reply", value: { id: 1n, accepted: false, reason: "old map" } });
    expect(await outcome).toEqual({ kind: "refused", reason: "old map" });
  });

  it("go again with the same id after a reconnect, in order", () => {
    goLive();
    connection.request(stop);
    connection.request({ case: "resume", value: {} });
    service.newest.break();
    clock.advance(0.25);
    goLive();
    expect(service.newest.requests().map(({ id }) => id)).toEqual([1n, 2n]);
  });

  it("are not repeated once answered", () => {
    goLive();
    connection.request(stop);
    service.newest.say({ case: "reply", value: { id: 1n, accepted: true } });
    service.newest.break();
    clock.advance(0.25);
    goLive();
    expect(service.newest.requests()).toEqual([]);
  });

  it("that were made while lost are sent when the link is back in time", () => {
    goLive();
    service.newest.break();
    connection.request(stop);
    clock.advance(0.25);
    goLive();
    expect(service.newest.requests()).toHaveLength(1);
  });

  it("that were made while lost are never sent once expired", async () => {
    goLive();
    service.newest.break();
    const outcome = connection.request(stop, { validFor: 0.2 });
    clock.advance(0.25);
    service.newest.open();
    service.newest.say({ case: "welcome", value: { run: "run-1", serviceTime: 9000.25 } });
    expect(service.newest.requests()).toEqual([]);
    expect(await outcome).toMatchObject({ kind: "not sent" });
  });

  it("that left the page and got no answer have an outcome of their own", async () => {
    goLive();
    const outcome = connection.request(stop, { validFor: 1 });
    clock.advance(2.5);
    expect(await outcome).toMatchObject({ kind: "unanswered" });
  });
});

describe("frames", () => {
  it("are requested again after a reconnect", () => {
    connection.attend(["r1", "r2"], ["r3"]);
    goLive();
    expect(service.newest.ofCase("attend")).toHaveLength(1);
    service.newest.break();
    clock.advance(0.25);
    goLive();
    expect(service.newest.ofCase("attend")[0]?.body.value).toMatchObject({
      robots: ["r1", "r2"],
      searches: ["r3"],
    });
  });

  it("are no longer requested when nobody looks", () => {
    goLive();
    connection.attend(["r1"], []);
    connection.attend([], []);
    expect(service.newest.ofCase("attend")[1]?.body.value).toMatchObject({ robots: [] });
  });
});

it("a new service learns where the page shows what", () => {
  goLive();
  connection.layout({ width: 800, height: 600 });
  service.newest.break();
  clock.advance(0.25);
  goLive();
  expect(service.newest.ofCase("layout")).toHaveLength(1);
  expect(service.newest.ofCase("layout")[0]?.body.value).toMatchObject({ width: 800 });
});

describe("another name", () => {
  it("is said in a new connection, which is no loss, once requests are answered", async () => {
    goLive();
    const outcome = connection.request(stop);
    const before = links.length;
    const renamed = connection.rename("Ann");
    expect(service.sockets).toHaveLength(1);
    service.newest.say({ case: "reply", value: { id: 1n, accepted: true } });
    await Promise.all([outcome, renamed]);
    expect(service.sockets).toHaveLength(2);
    service.newest.open();
    expect(service.newest.ofCase("hello")[0]?.body.value).toMatchObject({ name: "Ann" });
    service.newest.say(welcome);
    expect(links.slice(before).map(({ state }) => state)).toEqual(["live"]);
    expect(service.newest.ofCase("request")).toEqual([]);
    await connection.rename("Ann");
    expect(service.sockets).toHaveLength(2);
  });
});
