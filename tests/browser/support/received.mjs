import { decodeClient, decodeServer } from "./protocol.mjs";

const keys = {
  session: () => "",
  world: ({ name }) => name,
  belief: ({ world }) => world,
  robot: ({ name }) => name,
  snapshot: ({ robot, sequenceNumber }) => `${robot} ${sequenceNumber}`,
  trail: ({ robot, first }) => `${robot} ${first}`,
  attention: () => "",
  alert: ({ id }) => String(id),
  event: ({ id }) => String(id),
  service: ({ name }) => name,
  presence: () => "",
  playback: () => "",
  task: () => "",
  form: () => "",
  draft: () => "",
  studyLog: () => "",
  truth: ({ world }) => world,
};

/** The messages that a page received and sent, read from its real WebSockets. */
export class ReceivedMessages {
  welcome;
  /** Newest updates by kind and key. */
  #updates = new Map();
  /** Requests in the order of sending, including repeated ones. */
  asked = [];
  replies = [];
  /** Where the page said that it shows what. */
  layouts = [];
  /** Number of frames of streams. */
  frames = 0;
  /** How often the page has connected. */
  connections = 0;

  /** @param {import("playwright-core").Page} page */
  constructor(page) {
    page.on("websocket", (socket) => {
      this.connections += 1;
      socket.on("framereceived", ({ payload }) => this.#receive(decodeServer(payload).body));
      socket.on("framesent", ({ payload }) => {
        const { body } = decodeClient(payload);
        if (body.case === "request") this.asked.push(body.value);
        if (body.case === "layout") this.layouts.push(body.value);
      });
    });
  }

  /** The newest update of a kind, and of a key if the kind has keys. */
  newest(kind, key = "") {
    return this.#updates.get(`${kind}:${key}`);
  }

  all(kind) {
    const wanted = [...this.#updates].filter(([key]) => key.startsWith(`${kind}:`));
    return wanted.map(([, value]) => value);
  }

  robot(name) {
    return this.newest("robot", name);
  }

  belief(world = "w1") {
    return this.newest("belief", world);
  }

  control(robot) {
    return this.newest("control", robot);
  }

  /** Pictures of one robot, oldest first. */
  snapshots(robot) {
    return this.all("snapshot")
      .filter((picture) => picture.robot === robot)
      .sort((a, b) => Number(a.sequenceNumber - b.sequenceNumber));
  }

  isWall({ row, column }, world = "w1") {
    const { columns } = this.newest("world", world);
    return this.belief(world).walls[row * columns + column] >= 128;
  }

  /** Requests of a kind: edit, guide, drive, ... */
  requests(kind) {
    return this.asked.filter(({ body }) => body.case === kind);
  }

  replyTo({ id }) {
    return this.replies.find((reply) => reply.id === id);
  }

  #receive(body) {
    if (body.case === "welcome") this.welcome = body.value;
    if (body.case === "reply") this.replies.push(body.value);
    if (body.case === "frame") this.frames += 1;
    if (body.case !== "updates") return;
    if (body.value.everything) this.#updates.clear();
    for (const update of body.value.update) {
      const { case: kind, value } = update.body;
      const key = keys[kind] ?? (({ robot }) => robot);
      this.#updates.set(`${kind}:${key(value)}`, value);
    }
  }
}
