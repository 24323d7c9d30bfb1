// node bench_pages.mjs FOLDER: the browsers of ./conav bench console. Reads one JSON command per line, answers each with one line,
// and ends with its input.
//   {"do": "open", "url": U, "pages": N, "drive": D}  opens the console in new browsers until there are N; D: see age_probe.mjs
//   {"do": "begin"}, {"do": "end"}                    start and end of the measurement
//   {"do": "move", "seconds": S}                      moves the first page's map; see frame_probe.mjs
//   {"do": "signal", "name": S}                       signals the last browser; "end" skips it while it is stopped
import { join } from "node:path";
import { createInterface } from "node:readline";
import { ageProbe } from "./support/age_probe.mjs";
import { frameProbe } from "./support/frame_probe.mjs";
import { OwnBrowser } from "./support/own_browser.mjs";
import { patience } from "./support/wait.mjs";

const size = { width: 1400, height: 900 };
const [, , folder] = process.argv;
/** @type {OwnBrowser[]} */
const browsers = [];
let stalled = false;
let cpu = 0;

const commands = { open, begin, end, move, signal };

for await (const line of createInterface({ input: process.stdin })) {
  const { do: name, ...options } = JSON.parse(line);
  try {
    say((await commands[name](options)) ?? {});
  } catch (error) {
    say({ error: String(error) });
  }
}
signal({ name: "SIGCONT" });
await Promise.all(browsers.map((browser) => browser.stop()));

function say(answer) {
  process.stdout.write(`${JSON.stringify(answer)}\n`);
}

async function open({ url, pages, drive }) {
  while (browsers.length < pages) {
    const browser = new OwnBrowser(join(folder, `browser-${browsers.length}`), { url, ...size });
    browsers.push(browser);
    await browser.started();
    await browser.visit(async (page) => {
      await page.getByRole("application").waitFor({ timeout: 1000 * patience });
      await page.evaluate(ageProbe(drive));
    });
  }
}

async function begin() {
  await takeAll();
  cpu = cpuOfAll();
}

async function end() {
  const used = cpuOfAll() - cpu;
  return { pages: await takeAll(), cpu: used };
}

async function move({ seconds }) {
  const [browser] = browsers;
  const before = browser.cpu();
  const times = await browser.visit((page) => page.evaluate(frameProbe(seconds)));
  return { ...times, cpu: browser.cpu() - before };
}

function signal({ name }) {
  browsers.at(-1)?.signal(name);
  stalled = name === "SIGSTOP";
}

function takeAll() {
  const lively = stalled ? browsers.slice(0, -1) : browsers;
  const take = (page) => page.evaluate("conavAges.take()");
  return Promise.all(lively.map((browser) => browser.visit(take)));
}

function cpuOfAll() {
  return browsers.reduce((sum, browser) => sum + browser.cpu(), 0);
}
