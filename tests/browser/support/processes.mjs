import { spawn } from "node:child_process";
import { closeSync, openSync, readdirSync, readFileSync } from "node:fs";
import { until } from "./wait.mjs";

/** A process of ours, which ends when we do, in whatever way. */
export class Process {
  #child;
  #end;

  /**
   * @param {string} name
   * @param {readonly string[]} command
   * @param {{ log: string, stdin?: "pipe" | "ignore" }} options `log`: file of what it says
   */
  constructor(name, [program, ...words], { log, stdin = "ignore" }) {
    this.name = name;
    this.log = log;
    const file = openSync(log, "a");
    const tied = ["--pdeathsig", "TERM", "--", program, ...words];
    this.#child = spawn("setpriv", tied, { stdio: [stdin, file, file] });
    closeSync(file);
    this.#end = new Promise((resolve) => {
      this.#child.once("exit", (code, signal) => resolve(signal ?? code));
      this.#child.once("error", (error) => resolve(String(error)));
    });
    this.#end.then((how) => {
      this.ended = how;
    });
  }

  get pid() {
    const { pid } = this.#child;
    if (pid === undefined) throw new Error(`${this.name} did not start`);
    return pid;
  }

  get stdin() {
    return this.#child.stdin;
  }

  /** What it has said so far. */
  said() {
    return readFileSync(this.log, "utf8");
  }

  /** @param {NodeJS.Signals} signal */
  signal(signal) {
    if (this.ended === undefined) process.kill(this.pid, signal);
  }

  /** At once, without a chance to tidy up. */
  async kill() {
    this.signal("SIGKILL");
    await this.#end;
  }

  /** Asked nicely first. */
  async stop() {
    this.signal("SIGTERM");
    await until(`the end of ${this.name}`, () => this.ended !== undefined).catch(() => this.kill());
  }

  /**
   * Waits for what it says.
   * @param {RegExp} text
   * @param {() => string} [said] where it says it; default its own log
   */
  hears(text, said = () => this.said()) {
    return until(`${this.name} says ${text}`, () => {
      const found = text.exec(said());
      if (found === null && this.ended !== undefined) {
        throw new Error(
          `${this.name} ended (${this.ended}) without saying ${text}:\n${this.said().slice(-2000)}`,
        );
      }
      return found ?? undefined;
    });
  }
}

/** KiB of memory of its own that the process has in use. */
export function memoryOf(pid) {
  const status = readFileSync(`/proc/${pid}/status`, "utf8");
  return Number(/^RssAnon:\s+(\d+) kB$/m.exec(status)?.[1] ?? Number.NaN);
}

/** The process and all that come from it. */
export function familyOf(pid) {
  const parents = new Map(
    readdirSync("/proc")
      .filter((name) => /^\d+$/.test(name))
      .map((name) => [Number(name), parentOf(name)]),
  );
  const family = [pid];
  for (const one of family) {
    for (const [child, parent] of parents) if (parent === one) family.push(child);
  }
  return family;
}

/** s of processor time that the process has had; 0 when it has ended. */
export function cpuOf(pid) {
  try {
    // From the process's state on: utime and stime are the 14th and 15th of all, in 1/100 s.
    const words = readFileSync(`/proc/${pid}/stat`, "utf8").split(") ").at(-1).split(" ");
    return (Number(words[11]) + Number(words[12])) / 100;
  } catch {
    return 0;
  }
}

/** @param {readonly number[]} pids @param {NodeJS.Signals} name */
export function signalAll(pids, name) {
  for (const pid of pids) {
    try {
      process.kill(pid, name);
    } catch {
      // It has ended meanwhile.
    }
  }
}

function parentOf(name) {
  try {
    // The name of the program, in parentheses, may have anything in it.
    return Number(readFileSync(`/proc/${name}/stat`, "utf8").split(") ").at(-1)?.split(" ")[1]);
  } catch {
    return undefined; // it has ended meanwhile
  }
}
