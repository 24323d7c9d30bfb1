import { once } from "node:events";
import { connect, createServer } from "node:net";

/** A line between browser and service that can be held, cut and mended. */
export class Line {
  #server;
  /** @type {Set<[import("node:net").Socket, import("node:net").Socket]>} */
  #pairs = new Set();
  #holds = false;
  #isCut = false;

  static async to(url) {
    const { hostname, port } = new URL(url);
    const line = new Line(hostname, Number(port));
    line.#server.listen(0, "127.0.0.1");
    await once(line.#server, "listening");
    line.url = `http://127.0.0.1:${line.#server.address().port}`;
    return line;
  }

  constructor(host, port) {
    this.url = "";
    this.#server = createServer((near) => {
      if (this.#isCut) {
        near.destroy();
        return;
      }
      const far = connect(port, host);
      this.#join(near, far);
    });
  }

  /** Holds back the service's messages. The browser's messages still arrive. */
  hold() {
    this.#holds = true;
    for (const [, far] of this.#pairs) far.pause();
  }

  release() {
    this.#holds = false;
    for (const [, far] of this.#pairs) far.resume();
  }

  /** Closes all connections and refuses new ones. */
  cut() {
    this.#isCut = true;
    for (const [near, far] of this.#pairs) {
      near.destroy();
      far.destroy();
    }
  }

  mend() {
    this.#isCut = false;
  }

  async stop() {
    this.cut();
    this.#server.close();
    await once(this.#server, "close");
  }

  #join(near, far) {
    const pair = [near, far];
    this.#pairs.add(pair);
    near.on("data", (bytes) => far.write(bytes));
    far.on("data", (bytes) => near.write(bytes));
    if (this.#holds) far.pause();
    for (const [socket, other] of [
      [near, far],
      [far, near],
    ]) {
      socket.on("error", () => undefined);
      socket.on("close", () => {
        this.#pairs.delete(pair);
        other.destroy();
      });
    }
  }
}
