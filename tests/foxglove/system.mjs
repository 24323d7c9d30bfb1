import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { ServiceSystem } from "../browser/support/service_system.mjs";
import { until } from "../browser/support/wait.mjs";
import { Client } from "./client.mjs";

/** A simulator or a robot of the field, a planner, an operator service with an endpoint for Foxglove, and its clients. */
export class FoxgloveSystem {
  url = "";
  folder = mkdtempSync(join(tmpdir(), "conav-foxglove-"));
  #services = new ServiceSystem(this.folder);
  #clients = [];

  /** @param {object} [more] as of ServiceSystem */
  async start({ operator = {}, ...more } = {}) {
    const foxglove = { port: 0, ...operator.foxglove };
    await this.#services.start({ ...more, operator: { ...operator, foxglove } });
    this.url = await until("the address", () => / foxglove url=(\S+)/.exec(this.log())?.[1]);
  }

  /** Of the operator service. */
  log() {
    return readFileSync(this.#services.log("operator"), "utf8");
  }

  pidOf(service) {
    return this.#services.pidOf(service);
  }

  /** A new client that has connected. */
  client(options, suffix = "") {
    const client = new Client(this.url + suffix, options);
    this.#clients.push(client);
    return client.isReady();
  }

  async stop() {
    for (const client of this.#clients) client.socket.terminate();
    await this.#services.stop();
    rmSync(this.folder, { recursive: true });
  }
}

/**
 * A test with a system of its own.
 * @param {string} name a sentence that states the fact
 * @param {object | ((folder: string) => object)} more as of ServiceSystem
 * @param {(system: FoxgloveSystem) => Promise<void>} walk
 */
export function systemTest(name, more, walk) {
  test(name, async () => {
    const system = new FoxgloveSystem();
    try {
      await system.start(typeof more === "function" ? more(system.folder) : more);
      await walk(system);
    } catch (error) {
      if (system.url !== "") console.log(system.log().slice(-3000));
      throw error;
    } finally {
      await system.stop();
    }
  });
}
