import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { chromium } from "playwright-core";
import { executablePath, quiet } from "./browser.mjs";
import { cpuOf, familyOf, Process, signalAll } from "./processes.mjs";

/** A browser with one page that the test visits only briefly, so that testing does not disturb the measurement. */
export class OwnBrowser {
  #process;
  #address = "";

  /** @param {string} folder for its profile and log */
  constructor(folder, { url, width, height }) {
    mkdirSync(folder, { recursive: true });
    const words = [
      ...quiet,
      "--headless",
      "--remote-debugging-port=0",
      `--user-data-dir=${join(folder, "profile")}`,
      `--window-size=${width},${height}`,
      url,
    ];
    const log = join(folder, "chromium.log");
    this.#process = new Process("chromium", [executablePath, ...words], { log });
  }

  async started() {
    [, this.#address] = await this.#process.waitForOutput(/DevTools listening on (ws:\S+)/);
  }

  /**
   * @template T
   * @param {(page: import("playwright-core").Page) => Promise<T>} act
   */
  async visit(act) {
    const browser = await chromium.connectOverCDP(this.#address);
    try {
      const [page] = browser.contexts().flatMap((context) => context.pages());
      return await act(page);
    } finally {
      await browser.close(); // only disconnects
    }
  }

  /** Signals all of its processes. @param {NodeJS.Signals} name */
  signal(name) {
    signalAll(familyOf(this.#process.pid), name);
  }

  /** s of processor time of all its processes. */
  cpu() {
    return familyOf(this.#process.pid).reduce((sum, pid) => sum + cpuOf(pid), 0);
  }

  stop() {
    return this.#process.stop();
  }
}
