import { spawn } from "node:child_process";
import { closeSync, openSync, readdirSync, readFileSync } from "node:fs";
import { until } from "./wait.mjs";

/** A child process that ends when this process does, however it ends. */
export class Process {
  #child;
  #end;

  /**
   * @param {string} name
   * @param {readonly string[]} command
   * @param {{ log: string, stdin?: "pipe" | "ignore" }} options `log`: file of its output
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

  /** Its output so far. */
  output() {
    return readFileSync(this.log, "utf8");
  }

  /** @param {NodeJS.Signals} signal */
  signal(signal) {
    if (this.ended === undefined) process.kill(this.pid, signal);
  }

  /** Kills it at once. */
  async kill() {
    this.signal("SIGKILL");
    await this.#end;
  }

  /** Terminates it, and kills it if that does not help. */
  async stop() {
    this.signal("SIGTERM");
    await until(`the end of ${this.name}`, () => this.ended !== undefined).catch(() => this.kill());
  }

  /**
   * Waits until its output matches.
   * @param {RegExp} text
   * @param {() => string} [said] source of the output; default: its own log
   */
  waitForOutput(text, said = () => this.output()) {
    return until(`${this.name} says ${text}`, () => {
      const found = text.exec(said());
      if (found === null && this.ended !== undefined) {
        throw new Error(
          `${this.name} ended (${this.ended}) without saying ${text}:\n${this.output().slice(-2000)}`,
        );
      }
      return found ?? undefined;
    });
  }
}

/** KiB of private memory of the process. */
export function memoryOf(pid) {
  const status = readFileSync(`/proc/${pid}/status`, "utf8");
  return Number(/^RssAnon:\s+(\d+) kB$/m.exec(status)?.[1] ?? Number.NaN);
}

/** The process and all its descendants. */
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

/** The words with which the process was started. */
export function commandOf(pid) {
  try {
    return readFileSync(`/proc/${pid}/cmdline`, "utf8").split("\0");
  } catch {
    return []; // it has ended
  }
}

/** s of processor time that the process has had; 0 when it has ended. */
export function cpuOf(pid) {
  try {
    // Words after the program's name. utime and stime are fields 14 and 15 of the line, in 1/100 s.
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
      // It has already ended.
    }
  }
}

function parentOf(name) {
  try {
    // The program's name, in parentheses, may contain any character.
    return Number(readFileSync(`/proc/${name}/stat`, "utf8").split(") ").at(-1)?.split(" ")[1]);
  } catch {
    return undefined; // it has already ended
  }
}
