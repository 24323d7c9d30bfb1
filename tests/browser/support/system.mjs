import { existsSync, readdirSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { commandOf, familyOf, Process } from "./processes.mjs";
import { until } from "./wait.mjs";

const root = resolve(dirname(fileURLToPath(import.meta.url)), "../../..");

/** Folder of the programs. */
export const programs = process.env.CONAV_BIN_DIR ?? join(root, "build/release/bin");

/** What `conav demo` starts: all services and the simulated operator, the console on a port of its own. */
export class DemoSystem {
  #folder;
  #demo;
  #run = "";
  url = "";

  /** @param {string} folder for its run folder and log */
  constructor(folder) {
    this.#folder = folder;
  }

  /** @param {readonly string[]} options of the demo */
  async start(options) {
    const words = ["demo", "--console", "0", "--out", join(this.#folder, "runs"), ...options];
    const log = join(this.#folder, "demo.log");
    this.#demo = new Process("conav demo", [join(programs, "conav"), ...words], { log });
    [, this.#run] = await this.#demo.waitForOutput(/ run (\S+)/);
    [, this.url] = await this.#demo.waitForOutput(/^console (http:\S+)$/m);
  }

  /** Process id of a service that the demo has started. */
  pidOf(service) {
    const found = new RegExp(`started ${service} \\(pid (\\d+)\\)`).exec(this.#demo.output());
    if (found === null) throw new Error(`the demo has not started ${service}`);
    return Number(found[1]);
  }

  logs() {
    return [this.#demo.log, ...(this.#run === "" ? [] : [join(this.#run, "logs/operator.log")])];
  }

  async stop() {
    await this.#demo?.stop();
  }
}

/** `conav replay` of a finished demo. */
export class ReplaySystem {
  #folder;
  #processes = [];
  url = "";

  /** @param {string} folder for the run and logs */
  constructor(folder) {
    this.#folder = folder;
  }

  /** @param {readonly string[]} options of the headless demo that runs first */
  async start(options) {
    const out = join(this.#folder, "recorded");
    const demo = this.#run("conav", ["demo", "--headless", "--out", out, ...options]);
    const [, run] = await demo.waitForOutput(/ run (\S+)/);
    await until("the end of the demo", () => demo.ended !== undefined, { within: 120 });
    const replay = this.#run("conav-replay", [run, "--port", "0"]);
    [, this.url] = await replay.waitForOutput(/(http:\S+)/);
  }

  /** @param {NodeJS.Signals} signal to the service that replays */
  signal(signal) {
    this.#processes[1].signal(signal);
  }

  logs() {
    return this.#processes.map(({ log }) => log);
  }

  async stop() {
    await Promise.all(this.#processes.map((process) => process.stop()));
  }

  #run(program, words) {
    const log = join(this.#folder, `${program}.log`);
    const process = new Process(program, [join(programs, program), ...words], { log });
    this.#processes.push(process);
    return process;
  }
}

/** What `conav mapping-task` or `conav study --live` starts, on a port of its own. */
export class ParticipantSystem {
  #program;
  #log;
  #task;
  /** Of the participant, or of the study. */
  folder;
  url = "";

  /**
   * @param {string} program conav-mapping-task or conav-live-study
   * @param {string} folder for the participant's folder and the program's log
   */
  constructor(program, folder) {
    this.#program = program;
    this.folder = join(folder, "participant");
    this.#log = join(folder, `${program}.log`);
  }

  /** @param {readonly string[]} options of the program */
  async start(options) {
    const port = options.includes("--port") ? [] : ["--port", "0"];
    const words = [...port, "--out", this.folder, ...options];
    const command = [join(programs, this.#program), ...words];
    this.#task = new Process(this.#program, command, { log: this.#log });
    [, this.url] = await this.#task.waitForOutput(/^\d+ of .*(https?:\S+)$/m);
  }

  /** Kills the process that was started with this configuration, below the folder. */
  kill(config) {
    const file = join(this.folder, config);
    const pid = familyOf(this.#task.pid).find((one) => commandOf(one).includes(file));
    process.kill(pid, "SIGKILL");
  }

  logs() {
    const files = existsSync(this.folder) ? readdirSync(this.folder, { recursive: true }) : [];
    const logs = files.filter((name) => name.endsWith(".log"));
    return [this.#log, ...logs.map((name) => join(this.folder, name))];
  }

  async stop() {
    await this.#task?.stop();
  }
}
