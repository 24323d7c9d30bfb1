import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import protocol from "@foxglove/ws-protocol";
import WebSocket from "ws";
import { until } from "../browser/support/wait.mjs";

const { FoxgloveClient } = protocol;

export const bothProtocols = ["foxglove.sdk.v1", "foxglove.websocket.v1"];

/** One connection of the client that Foxglove publishes, and all that it received. */
export class Client {
  channels = new Map(); // by topic
  services = new Map(); // by name
  statuses = [];
  graphs = [];
  parameters = [];
  assets = [];
  answers = [];
  failures = [];
  times = [];
  errors = [];
  #topics = new Map(); // by subscription
  #readers = new Map(); // by topic
  messages = new Map(); // by topic: decoded, newest last
  closed;

  /**
   * @param {string} url
   * @param {{ protocols?: string[], origin?: string, headers?: Record<string, string>, ca?: Buffer }} [options]
   *   `ca`: the only certificate that is trusted
   */
  constructor(url, { protocols = ["foxglove.websocket.v1"], origin, headers, ca } = {}) {
    this.socket = new WebSocket(url, protocols, { origin, headers, ca });
    this.client = new FoxgloveClient({ ws: this.socket });
    const keep = (event, list) => this.client.on(event, (body) => list.push(body));
    this.client.on("open", () => {
      this.protocol = this.socket.protocol;
    });
    this.client.on("close", (event) => {
      this.closed = event.code;
    });
    this.client.on("error", (error) => this.errors.push(String(error)));
    this.client.on("serverInfo", (info) => {
      this.info = info;
    });
    this.client.on("advertise", (channels) => {
      for (const channel of channels) this.channels.set(channel.topic, channel);
    });
    this.client.on("advertiseServices", (services) => {
      for (const service of services) this.services.set(service.name, service);
    });
    this.client.on("message", (message) => this.#take(message));
    keep("status", this.statuses);
    keep("time", this.times);
    keep("parameterValues", this.parameters);
    keep("connectionGraphUpdate", this.graphs);
    keep("fetchAssetResponse", this.assets);
    keep("serviceCallResponse", this.answers);
    keep("serviceCallFailure", this.failures);
  }

  /** Waits until the server has introduced itself. */
  async isReady() {
    await until("channels and services", () => this.services.size > 0, { now: () => this.errors });
    return this;
  }

  /** @param {Iterable<string>} topics */
  subscribe(topics) {
    for (const topic of topics) {
      const channel = this.channels.get(topic);
      if (channel === undefined) throw new Error(`${topic} is not advertised`);
      this.#readers.set(topic, new MessageReader(parse(channel.schema, { ros2: true })));
      this.messages.set(topic, []);
      this.#topics.set(this.client.subscribe(channel.id), topic);
    }
  }

  unsubscribeAll() {
    for (const subscription of this.#topics.keys()) this.client.unsubscribe(subscription);
    this.#topics.clear();
  }

  /** The newest message of a topic that `fits`, which may be waited for. */
  newest(topic, fits = () => true, options = {}) {
    return until(
      `a message on ${topic}`,
      () => this.messages.get(topic).findLast(({ message }) => fits(message))?.message,
      {
        now: () => [this.messages.get(topic).at(-1), this.statuses.at(-1), this.errors],
        ...options,
      },
    );
  }

  /** Calls a Trigger; its response, or the failure's message. */
  async call(name, { encoding = "cdr", payload = new Uint8Array([0, 1, 0, 0, 0]) } = {}) {
    const { id, response } = this.services.get(name);
    const callId = this.answers.length + this.failures.length + 1;
    this.client.sendServiceCallRequest({ serviceId: id, callId, encoding, data: payload });
    const of = (list) => list.find((answer) => answer.callId === callId);
    const answer = await until(
      `the answer of ${name}`,
      () => of(this.answers) ?? of(this.failures),
    );
    if (answer.message !== undefined) return { failure: answer.message };
    if (answer.encoding === "json") return JSON.parse(new TextDecoder().decode(answer.data));
    return new MessageReader(parse(response.schema, { ros2: true })).readMessage(answer.data);
  }

  async parametersOf(names, id) {
    this.client.getParameters(names, id);
    return (await until("parameters", () => this.parameters.find((one) => one.id === id)))
      .parameters;
  }

  async asset(uri, id) {
    this.client.fetchAsset(uri, id);
    return until(`the asset ${uri}`, () => this.assets.find((one) => one.requestId === id));
  }

  close() {
    this.client.close();
  }

  #take({ subscriptionId, timestamp, data }) {
    const topic = this.#topics.get(subscriptionId);
    if (topic === undefined) return; // on its way when it was unsubscribed
    this.messages
      .get(topic)
      .push({ timestamp, message: this.#readers.get(topic).readMessage(data) });
  }
}

/** The status of the answer to an upgrade that is refused; 101 when it is not. */
export function refusalOf(url, { protocols = bothProtocols, origin, headers } = {}) {
  return new Promise((resolve, reject) => {
    const socket = new WebSocket(url, protocols, { origin, headers });
    socket.on("unexpected-response", (_request, response) => {
      resolve(response.statusCode);
      socket.terminate();
    });
    socket.on("open", () => {
      resolve(101);
      socket.close();
    });
    socket.on("error", reject);
  });
}
