import assert from "node:assert/strict";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { launch } from "./browser.mjs";
import { ConsolePage, connectionTrouble } from "./console_page.mjs";
import { Line } from "./line.mjs";
import { Process } from "./processes.mjs";
import { ServiceSystem } from "./service_system.mjs";
import { shiftProbe } from "./shift_probe.mjs";
import { DemoSystem, ParticipantSystem, ReplaySystem } from "./system.mjs";

/** Folder for screenshots of failed journeys. */
const failures = process.env.CONAV_BROWSER_FAILURES ?? join(tmpdir(), "conav-browser-failures");

/** Wide enough for all panels. */
export const screen = { width: 1400, height: 900 };

/** Options of a demo whose one robot is driven by hand. */
export const teleoperation = [
  ...["--robots", "1", "--seed", "7"],
  ...["--method", "teleop", "--operator", "silent"],
];

/** Everything that a journey has started. Ends it in reverse order. */
export class Scene {
  /** Browser errors that the journey causes on purpose. */
  expectedFaults = undefined;
  #ends = [];
  #pages = [];
  #systems = [];
  #browser;

  constructor(name) {
    this.name = name;
    this.folder = mkdtempSync(join(tmpdir(), "conav-browser-"));
  }

  /** Runs `act` at the end of the scene. */
  later(act) {
    this.#ends.push(act);
  }

  /** The whole system as `conav demo` starts it; options as on its command line. */
  async demo(...options) {
    const system = this.#keep(new DemoSystem(this.folder));
    await system.start(options);
    return system;
  }

  /** The recording of a headless demo; options as on its command line. */
  async replay(...options) {
    const system = this.#keep(new ReplaySystem(this.folder));
    await system.start(options);
    return system;
  }

  /** Services without a simulated operator; see ServiceSystem. */
  async services(more) {
    const system = this.#keep(new ServiceSystem(this.folder));
    await system.start(more);
    return system;
  }

  /** A participant's mazes; options as on the command line of `conav mapping-task`. */
  mappingTask(...options) {
    return this.#participant("conav-mapping-task", ["--speed", "20", ...options]);
  }

  /** One participant's way through a protocol; options as on the command line of `conav study --live`. */
  liveStudy(...options) {
    return this.#participant("conav-live-study", options);
  }

  /** Address of Pupil Remote: a stand-in of Pupil Capture, whose recording is synthetic. */
  async eyeTracker() {
    const log = join(this.folder, "eye_tracker.log");
    const program = fileURLToPath(new URL("../../support/pupil_standin.py", import.meta.url));
    const tracker = new Process("pupil_standin", [program], { log });
    this.later(() => tracker.stop());
    const [, address] = await tracker.waitForOutput(/^pupil remote (tcp:\S+)$/m);
    return address;
  }

  async #participant(program, options) {
    const system = this.#keep(new ParticipantSystem(program, this.folder));
    await system.start(options);
    return system;
  }

  async line(url) {
    const line = await Line.to(url);
    this.later(() => line.stop());
    return line;
  }

  /**
   * The console in a browser profile of its own.
   * @param {string} url
   * @param {{ name?: string, browser?: import("playwright-core").Browser } & import("playwright-core").BrowserContextOptions} [options]
   */
  async open(url, options) {
    const page = await this.openOnly(url, options);
    await page.isReady();
    return page;
  }

  /** Opens the page without waiting for its content. An empty name: the person has not given one yet. */
  async openOnly(url, { name = "Ada", browser, ...options } = {}) {
    const context = await (browser ?? (await this.#launch())).newContext({
      viewport: screen,
      ...options,
    });
    if (name) await context.addInitScript((text) => localStorage.setItem("conav.name", text), name);
    await context.addInitScript(shiftProbe);
    const page = new ConsolePage(await context.newPage());
    this.#pages.push(page);
    await page.page.goto(url);
    return page;
  }

  /** What the browser complained of, and what moved the map under the pointer. */
  async checkFaults() {
    const expected = this.expectedFaults ?? /^$/;
    const faults = this.#pages
      .flatMap((page) => page.faults)
      .filter((fault) => !expected.test(fault));
    assert.deepEqual(faults, [], "the browser complains of the page");
    for (const { page } of this.#pages.filter(({ page }) => !page.isClosed())) {
      const shifts = await page.evaluate(() => globalThis.conavShifts ?? []);
      assert.deepEqual(shifts, [], "the map stays where it is");
    }
  }

  /** The journey stops the service on purpose. */
  expectConnectionTrouble() {
    this.expectedFaults = connectionTrouble;
  }

  /** Reports screenshots, browser errors and logs after a failure. */
  async report() {
    mkdirSync(failures, { recursive: true });
    const stem = this.name.replace(/[^a-z0-9]+/gi, "_").slice(0, 60);
    for (const [i, { page, faults }] of this.#pages.entries()) {
      const path = join(failures, `${stem}-${i}.png`);
      await page.screenshot({ path, timeout: 5000 }).catch(() => undefined);
      console.log(`page ${i}: ${path}${faults.map((fault) => `\n  ${fault}`).join("")}`);
    }
    for (const system of this.#systems) {
      // The log may be missing.
      for (const log of system.logs().filter((file) => existsSync(file))) {
        console.log(`${log}:\n${readFileSync(log, "utf8").slice(-3000)}`);
      }
    }
  }

  /** Ends everything, even if some of it fails. */
  async end() {
    const faults = [];
    for (const act of this.#ends.reverse()) {
      try {
        await act();
      } catch (error) {
        faults.push(error);
      }
    }
    rmSync(this.folder, { recursive: true, force: true });
    if (faults.length > 0) throw new AggregateError(faults, `${this.name}: could not tidy up`);
  }

  #keep(system) {
    this.#systems.push(system);
    this.later(() => system.stop());
    return system;
  }

  async #launch() {
    if (this.#browser === undefined) {
      const browser = await launch();
      this.#browser = browser;
      this.later(() => browser.close());
    }
    return this.#browser;
  }
}
