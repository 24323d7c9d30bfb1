import assert from "node:assert/strict";
import { randomBytes } from "node:crypto";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { parse } from "@foxglove/rosmsg";
import { MessageWriter } from "@foxglove/rosmsg2-serialization";
import { makeCertificate } from "../browser/support/certificate.mjs";
import { stays, until } from "../browser/support/wait.mjs";
import { bothProtocols, refusalOf } from "./client.mjs";
import { systemTest } from "./system.mjs";

const json = (value) => new TextEncoder().encode(JSON.stringify(value));
/** Robots do not wait for answers. */
const restless = { first_guidance_timeout_s: 0.2, answer_timeout_s: 0.2 };
/** Topics on which a system without a simulated operator speaks once its robots drive. */
const spoken = [
  ...["state", "map", "goals", "odom", "tf", "camera/camera_info", "snapshot"].map(
    (name) => `/r1/${name}`,
  ),
  ...["command", "plan", "search", "attention"].map((name) => `/r2/${name}`),
  ...["belief", "belief/map", "initial_map", "truth", "goals"].map((name) => `/w1/${name}`),
  ...["/conav/planner/lease", "/conav/operator/attention_queue", "/conav/operator/event"],
  ...["/clock", "/diagnostics", "/rosout"],
];
const tokens = [
  { name: "olga", role: "observer", token: "observer-token" },
  { name: "otto", role: "operator", token: "operator-token" },
];

function isAt(pose, { x, y }, within) {
  return Math.hypot(pose.position.x - x, pose.position.y - y) < within;
}

systemTest(
  "all topics are advertised and decoded, at eight clients of which one is stalled",
  { robots: 2, planner: restless },
  async (system) => {
    const clients = [];
    for (let i = 0; i < 8; i += 1) {
      clients.push(
        await system.client({ protocols: i % 2 === 0 ? ["foxglove.websocket.v1"] : bothProtocols }),
      );
    }
    const [first, second] = clients;
    assert.equal(first.protocol, "foxglove.websocket.v1");
    assert.equal(second.protocol, "foxglove.sdk.v1");
    assert.deepEqual(first.info.supportedEncodings, ["cdr", "json"]);
    assert.ok(first.info.sessionId.length > 10 && first.info.sessionId === second.info.sessionId);
    assert.deepEqual(first.channels, second.channels);
    for (const topic of [
      "/r1/odom",
      "/r2/state",
      "/w1/belief/map",
      "/clock",
      "/rosout",
      "/conav/operator/event",
    ]) {
      assert.ok(first.channels.has(topic), topic);
    }
    const topics = [...first.channels.keys()];
    for (const client of clients) client.subscribe(topics);
    const stalled = clients.pop();
    stalled.socket.pause();

    assert.deepEqual(await first.call("/r1/resume"), { success: true, message: "" });
    await second.call("/r2/resume");
    for (const client of clients) {
      for (const topic of spoken) await client.newest(topic);
    }
    // A late subscriber gets what is latched, though the service has subscribed before.
    const late = await system.client();
    late.subscribe(["/r1/map", "/w1/belief/map", "/r1/state"]);
    for (const topic of ["/r1/map", "/w1/belief/map", "/r1/state"]) await late.newest(topic);
    // Time is that of the simulator, and messages carry it.
    const [before] = first.times;
    await until(
      "time goes on",
      () => first.times.at(-1).timestamp > before.timestamp + 1_000_000_000n,
    );
    const { timestamp, message } = first.messages.get("/r1/odom").at(-1);
    const stamp =
      BigInt(message.header.stamp.sec) * 1_000_000_000n + BigInt(message.header.stamp.nsec);
    assert.equal(timestamp, stamp);
    const [{ timestamp: received }] = first.messages.get("/diagnostics").slice(-1);
    assert.ok(received < 1_000_000_000_000n, `wall time: ${received}`);
    // The stalled client is given up; the others got everything meanwhile, and nobody skipped anything.
    await until("the end of the stalled client", () => /foxglove client left/.test(system.log()), {
      within: 60,
    });
    const stamps = clients.map((client) => [
      ...new Set(client.messages.get("/r1/state").map(({ timestamp }) => timestamp)),
    ]);
    const all = [...new Set(stamps.flat())].sort((a, b) => (a < b ? -1 : 1));
    for (const got of stamps) {
      const begin = all.indexOf(got[0]);
      assert.ok(got.length > 20);
      assert.deepEqual(got, all.slice(begin, begin + got.length));
      assert.ok(got.at(-1) > all.at(-1) - 5_000_000_000n, "late");
    }
    for (const client of clients) {
      assert.deepEqual(client.statuses, []);
      assert.deepEqual(client.errors, []);
    }
  },
);

systemTest("the service subscribes while somebody does", { robots: 1 }, async (system) => {
  const client = await system.client();
  client.subscribe(["/diagnostics"]);
  const subscribed = (count) => {
    client.messages.get("/diagnostics").length = 0; // what was counted before
    return client.newest("/diagnostics", ({ status }) => {
      const values = status.find(({ hardware_id }) => hardware_id === "operator")?.values ?? [];
      return values.some(({ key, value }) => key === "foxglove_topics" && value === String(count));
    });
  };
  await subscribed(1);
  const other = await system.client();
  other.subscribe(["/r1/map", "/r1/state"]);
  await subscribed(3);
  other.unsubscribeAll();
  await subscribed(1);
  other.subscribe(["/r1/map"]);
  await subscribed(2);
  await until("a map", () => other.messages.get("/r1/map").length > 0);
  other.close();
  await subscribed(1);
  assert.equal(other.messages.get("/r1/map").length, 1);
});

systemTest(
  "the stop of a client makes a moving robot stand",
  { robots: 1, planner: restless },
  async (system) => {
    const client = await system.client();
    client.subscribe(["/r1/odom", "/r1/state", "/conav/operator/event"]);
    const place = () => client.messages.get("/r1/odom").at(-1).message.pose.pose;
    const start = (await client.newest("/r1/odom")).pose.pose;
    await client.call("/r1/resume", { encoding: "json", payload: json({}) });
    await client.newest("/r1/odom", ({ pose }) => !isAt(pose.pose, start.position, 0.5));
    assert.deepEqual(await client.call("/r1/stop"), { success: true, message: "" });
    await client.newest("/r1/state", ({ stopped }) => stopped);
    const { position } = place();
    await stays("a stopped robot stands", 2, () => isAt(place(), position, 0.6));
    await client.newest("/conav/operator/event", ({ text }) => /by Foxglove/.test(text));
  },
);

systemTest(
  "a goal that a client publishes moves a robot, unless it is stopped",
  {
    robots: 1,
    field: true,
    planner: { method: "greedy" },
    operator: { goals: { robots: ["r1"] } },
  },
  async (system) => {
    const client = await system.client();
    client.subscribe(["/r1/state", "/r1/goals"]);
    const place = () => client.messages.get("/r1/state").at(-1).message.pose;
    const [start, near, far] = [
      { x: 100.75, y: -46.75 },
      { x: 101.25, y: -49.25 },
      { x: 102.25, y: -49.25 },
    ];
    const channel = (encoding) =>
      client.client.advertise({
        topic: "/r1/goal_pose",
        encoding,
        schemaName: "geometry_msgs/PoseStamped",
      });
    const pose = ({ x, y }) => ({
      header: { stamp: { sec: 0, nsec: 0 }, frame_id: "map" },
      pose: { position: { x, y, z: 0 }, orientation: { x: 0, y: 0, z: 0, w: 1 } },
    });
    await client.newest("/r1/state", ({ stopped }) => stopped);
    await client.call("/r1/resume");
    await stays("a robot without a goal stands", 1, () => isAt(place(), start, 0.1));
    client.client.sendMessage(channel("json"), json(pose(near)));
    await until("the robot is there", () => isAt(place(), near, 0.5), { now: place });

    await client.call("/r1/stop");
    await client.newest("/r1/state", ({ stopped }) => stopped);
    const writer = new MessageWriter(
      parse(client.channels.get("/r1/goal_pose").schema, { ros2: true }),
    );
    client.client.sendMessage(channel("cdr"), writer.writeMessage(pose(far)));
    await client.newest("/r1/goals", ({ left }) => left?.length === 1);
    await stays("a stopped robot stands", 1, () => isAt(place(), near, 0.5));
    await client.call("/r1/resume");
    await until("the robot is there", () => isAt(place(), far, 0.5), { now: place });
    assert.deepEqual(client.statuses, []);
  },
);

systemTest(
  "rights are those of the token",
  {
    robots: 1,
    tokens,
    operator: { foxglove: { origins: ["https://app.foxglove.dev"] } },
  },
  async (system) => {
    for (const [suffix, options, status] of [
      ["", {}, 401],
      ["/?token=wrong-wrong-wrong", {}, 401],
      ["/?token=observer-token", { origin: "https://evil.example" }, 403],
      ["/?token=observer-token", { headers: { Host: "evil.example" } }, 403],
      ["/?token=observer-token", { protocols: [] }, 400],
      ["/?token=observer-token", { protocols: ["mqtt"] }, 400],
      ["/?token=observer-token", { origin: "https://app.foxglove.dev" }, 101],
      ["", { headers: { Authorization: "Bearer operator-token" } }, 101],
    ]) {
      assert.equal(
        await refusalOf(system.url + suffix, options),
        status,
        `${suffix} ${JSON.stringify(options)}`,
      );
    }
    const observer = await system.client({}, "/?token=observer-token");
    observer.subscribe(["/r1/state"]);
    const complains = (text) =>
      until(text, () => observer.statuses.some(({ message }) => message.includes(text)), {
        now: () => observer.statuses,
      });
    observer.client.advertise({
      topic: "/r1/goal_pose",
      encoding: "json",
      schemaName: "geometry_msgs/PoseStamped",
    });
    await complains("an observer may only watch");
    const refused = await observer.call("/r1/resume");
    assert.equal(refused.success, false);
    assert.match(refused.message, /observer/);
    assert.equal((await observer.call("/r1/stop")).success, true);

    const operator = await system.client({}, "/?token=operator-token");
    assert.equal((await operator.call("/r1/resume")).success, true);
    await observer.newest("/r1/state", ({ stopped }) => !stopped);
  },
);

systemTest(
  "parameters, services, the graph and assets answer, or say why not",
  { robots: 1 },
  async (system) => {
    const client = await system.client();
    const names = [
      "/operator.robots",
      "/operator.foxglove.queue_mib",
      "/operator.bus.interface",
      "/operator.nothing",
    ];
    assert.deepEqual(await client.parametersOf(names, "three"), [
      { name: "/operator.robots", value: ["w1/r1"] },
      { name: "/operator.foxglove.queue_mib", value: 8 },
      { name: "/operator.bus.interface", value: "lo" },
    ]);
    assert.ok((await client.parametersOf([], "all")).length > 40);
    client.client.setParameters([{ name: "/operator.foxglove.queue_mib", value: 9 }], "set");
    await until(
      "the value as it is",
      () => client.parameters.find(({ id }) => id === "set")?.parameters[0].value === 8,
    );
    await until("a status", () =>
      client.statuses.some(({ message }) => message.includes("cannot be set")),
    );

    const failure = await client.call("/r1/stop", { encoding: "ros1" });
    assert.match(failure.failure, /encoding/);
    client.client.subscribeConnectionGraph();
    const nodesOf = (list, topic, key) => list.find(({ name }) => name === topic)?.[key] ?? [];
    const graph = await until(
      "the graph",
      () =>
        client.graphs.findLast(
          ({ publishedTopics }) =>
            nodesOf(publishedTopics, "/r1/command", "publisherIds").length > 0 &&
            nodesOf(publishedTopics, "/r1/state", "publisherIds").length > 0,
        ),
      { now: () => client.graphs.at(-1)?.publishedTopics.slice(0, 6) },
    );
    assert.deepEqual(nodesOf(graph.publishedTopics, "/r1/command", "publisherIds"), ["/planner"]);
    assert.deepEqual(nodesOf(graph.publishedTopics, "/r1/guidance", "publisherIds"), ["/operator"]);
    // By the table of topics: the operator's side may read it, too.
    assert.deepEqual(nodesOf(graph.subscribedTopics, "/r1/guidance", "subscriberIds"), [
      "/operator",
      "/planner",
    ]);
    assert.deepEqual(nodesOf(graph.advertisedServices, "/r1/stop", "providerIds"), ["/operator"]);

    const asset = await client.asset("package://conav/r1.urdf", 7);
    if (client.channels.has("/r1/robot_description")) {
      assert.match(new TextDecoder().decode(asset.data), /<robot/);
    } else {
      assert.match(asset.error, /no topic/);
    }
    assert.match((await client.asset("file:///etc/passwd", 8)).error, /only package/);
  },
);

systemTest(
  "garbage of clients harms nobody",
  { robots: 1, operator: { console: { message_burst: 2000, message_rate: 2000 } } },
  async (system) => {
    const other = await system.client();
    other.subscribe(["/clock"]);
    const texts = [
      "",
      "{}",
      "[]",
      "null",
      '{"op":7}',
      '{"op":"subscribe"}',
      '{"op":"subscribe","subscriptions":[{"id":-1,"channelId":1e99}]}',
      '{"op":"subscribe","subscriptions":[{"id":1,"channelId":4294967295}]}',
      `{"op":"getParameters","parameterNames":[${"[".repeat(5000)}`,
      '{"op":"unsubscribe","subscriptionIds":[9]}',
      '{"op":"\ud800"}',
      '{"op":"advertise","channels":[{"id":1,"topic":"/r1/command","encoding":"cdr","schemaName":"x"}]}',
      `{"op":"fetchAsset","requestId":1,"uri":"${"x".repeat(3000)}"}`,
      '{"op":"playbackControl"}',
    ];
    const binaries = [
      [],
      [0],
      [1],
      [1, 0, 0, 0],
      [2, 1, 0, 0, 0, 0, 0, 0, 0, 255, 255, 255, 255],
      [2, 1, 0, 0, 0, 1, 0, 0, 0, 3, 0, 0, 0, 99],
      [255],
    ].map((bytes) => new Uint8Array(bytes));
    for (const message of [...texts, ...binaries]) {
      const client = await system.client();
      client.socket.send(message);
      await until("a complaint", () => client.statuses.length + client.failures.length > 0, {
        now: () => String(message).slice(0, 60),
      });
      assert.equal(client.closed, undefined);
      client.close();
    }
    // Again and again: it is closed.
    const client = await system.client();
    for (let i = 0; i < 200; i += 1) client.socket.send(randomBytes(i));
    await until("the end of the client", () => client.closed !== undefined);
    const large = await system.client();
    large.socket.send(randomBytes(1_000_000));
    await until("the end of the client", () => large.closed !== undefined);
    const at = other.messages.get("/clock").length;
    await until("the other goes on", () => other.messages.get("/clock").length > at + 5);
    assert.deepEqual(other.statuses, []);
  },
);

systemTest(
  "with a certificate the connection is encrypted",
  (folder) => ({ robots: 1, operator: { console: { tls: makeCertificate(folder) } } }),
  async (system) => {
    assert.match(system.url, /^wss:/);
    const ca = readFileSync(join(system.folder, "certificate.pem"));
    const client = await system.client({ ca });
    client.subscribe(["/r1/state"]);
    await client.newest("/r1/state");
    await assert.rejects(refusalOf(system.url), /self-signed/);
  },
);
