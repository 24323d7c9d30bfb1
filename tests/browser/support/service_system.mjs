import { createHash } from "node:crypto";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { leaseDomain } from "./domain.mjs";
import { Process } from "./processes.mjs";
import { programs } from "./system.mjs";

/**
 * Simulator (or a robot of the field), planner and operator service without a simulated operator. Each can be killed and restarted
 * on the same port and database.
 */
export class ServiceSystem {
  /** @type {Map<string, Process>} */
  #services = new Map();
  #starts = 0;

  #folder;
  #domain = 0;
  #keeper;
  url = "";

  /** @param {string} folder for configuration, database and logs */
  constructor(folder) {
    this.#folder = folder;
  }

  /**
   * @param {{ robots?: number, field?: boolean, sim?: object, planner?: object, operator?: object,
   *   tokens?: { name: string, role: string, token: string }[] }} [more] keys of the configuration files; `field`: a robot that
   *   is not the simulator's and keeps no goals (tests/system/robot/field_robot.h); `tokens`: who may open the console. Without
   *   robots the operator service runs alone.
   */
  async start({
    robots = 2,
    field = false,
    sim = {},
    planner = {},
    operator = {},
    tokens = [],
  } = {}) {
    const { domain, keeper } = await leaseDomain(join(this.#folder, "domain"));
    this.#domain = domain;
    this.#keeper = keeper;
    const names = Array.from({ length: robots }, (_, i) => `r${i + 1}`);
    const placed = names.map((name) => `w1/${name}`);
    this.#write("sim", { world: "w1", robots: names, seed: 7, speed: 4, ...sim });
    this.#write("planner", { robots: placed, perception: "embedded", ...planner });
    this.#write("operator", {
      robots: placed,
      database: join(this.#folder, "operator.db"),
      control: { start_stopped: true },
      ...operator,
      console: { port: 0, ...this.#writeTokens(tokens), ...operator.console },
    });
    const others = [field ? "field_robot" : "sim", "planner"];
    for (const service of ["operator", ...(robots > 0 ? others : [])]) this.#run(service);
    this.url = await this.#address();
    // Keep this port for the next start.
    const { port } = new URL(this.url);
    const file = this.#config("operator");
    writeFileSync(file, readFileSync(file, "utf8").replace('"port": 0', `"port": ${port}`));
  }

  pidOf(service) {
    return this.#one(service).pid;
  }

  /** @param {NodeJS.Signals} signal */
  signal(service, signal) {
    this.#one(service).signal(signal);
  }

  kill(service) {
    return this.#one(service).kill();
  }

  /** Restarts a service with the same configuration and waits until it serves the page again. */
  async startAgain(service) {
    this.#run(service);
    if (service === "operator") await this.#address();
  }

  /** Ends the operator service, and starts it with another task on the same port. */
  async startTask(task) {
    await this.#one("operator").stop();
    const file = this.#config("operator");
    const config = JSON.parse(readFileSync(file, "utf8"));
    config.operator.ros__parameters.task = task;
    writeFileSync(file, JSON.stringify(config, undefined, 1));
    await this.startAgain("operator");
  }

  /** The file of a service's log. */
  log(service) {
    return this.#one(service).log;
  }

  logs() {
    return [...this.#services.values()].map(({ log }) => log);
  }

  async stop() {
    await Promise.all([...this.#services.values()].map((service) => service.stop()));
    await this.#keeper?.stop();
  }

  async #address() {
    const [, url] = await this.#one("operator").waitForOutput(/ console url=(\S+)/);
    return url;
  }

  #one(service) {
    const found = this.#services.get(service);
    if (found === undefined) throw new Error(`no service ${service}`);
    return found;
  }

  #config(service) {
    return join(this.#folder, `${service}.yaml`);
  }

  /** As `conav token add` does. */
  #writeTokens(tokens) {
    if (tokens.length === 0) return {};
    const file = join(this.#folder, "tokens.json");
    const list = tokens.map(({ name, role, token }) => {
      const sha256 = createHash("sha256").update(token).digest("hex");
      return { name, role, ends_s: 1e10, sha256 };
    });
    writeFileSync(file, JSON.stringify({ tokens: list }));
    return { token_file: file };
  }

  /** JSON is YAML. */
  #write(service, keys) {
    const bus = { domain_id: this.#domain, interface: "lo" };
    const parameters = { [service]: { ros__parameters: { bus, ...keys } } };
    writeFileSync(this.#config(service), JSON.stringify(parameters, undefined, 1));
  }

  #run(service) {
    this.#starts += 1;
    const command =
      service === "field_robot"
        ? [join(programs, service), String(this.#domain)]
        : [join(programs, `conav-${service}`), "--config", this.#config(service)];
    const log = join(this.#folder, `${service}-${this.#starts}.log`);
    this.#services.set(service, new Process(service, command, { log }));
  }
}
