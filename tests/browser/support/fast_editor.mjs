import { encodeClient } from "./protocol.mjs";

const pause = 33; // ms; the service sends updates to a page at most so often

/**
 * Another client that edits as fast as the service sends updates: a real connection of a real browser, without the page.
 */
export class FastEditor {
  #page;
  #url;
  #name = 0;

  /** @param {import("playwright-core").Page} page of the same browser profile as a console */
  constructor(page, url) {
    this.#page = page;
    this.#url = url;
  }

  static async of({ page }) {
    const { origin } = new URL(page.url());
    const own = await page.context().newPage();
    await own.goto(`${origin}/livez`);
    return new FastEditor(own, `${origin.replace("http", "ws")}/ws`);
  }

  /**
   * Makes a wall of a free cell, frees it, makes it a wall, ...
   * @param {bigint} current revision of the map; nobody else may edit
   */
  async toggles(cell, times, revision) {
    this.#name += 1;
    const instance = `fasteditor${this.#name}-0123456789`;
    const until = Date.now() / 1000 + 60;
    const edit = (i) => ({
      baseRevision: revision + BigInt(i),
      cells: [{ cell, wall: i % 2 === 0 }],
    });
    const request = (i) => ({
      id: BigInt(i + 1),
      validUntil: until,
      world: "w1",
      body: { case: "edit", value: edit(i) },
    });
    const messages = [
      encodeClient({ case: "hello", value: { name: "Fast editor", instance } }),
      ...Array.from({ length: times }, (_, i) =>
        encodeClient({ case: "request", value: request(i) }),
      ),
    ];
    await this.#page.evaluate(sendAll, {
      url: this.#url,
      messages: messages.map((message) => Buffer.from(message).toString("base64")),
      pause,
    });
  }
}

/** Runs in the browser. */
function sendAll({ url, messages, pause }) {
  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Promise((resolve, reject) => {
    const socket = new WebSocket(url);
    socket.onclose = ({ reason }) => reject(new Error(`closed: ${reason}`));
    socket.onopen = () => {
      const timer = setInterval(() => {
        const next = messages.shift();
        if (next !== undefined) {
          socket.send(bytes(next));
          return;
        }
        clearInterval(timer);
        socket.onclose = resolve;
        socket.close();
      }, pause);
    };
  });
}
