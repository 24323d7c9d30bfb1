import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { writeBigMap } from "../support/big_map.mjs";
import { connect, launchServer } from "../support/browser.mjs";
import { FastEditor } from "../support/fast_editor.mjs";
import { journey } from "../support/journey.mjs";
import { familyOf, memoryOf, signalAll } from "../support/processes.mjs";
import { texts } from "../support/texts.mjs";
import { until } from "../support/wait.mjs";

const mostGrowth = 8 * 1024; // KiB
const mostWaiting = 100_000; // bytes; the kernel takes some 5 MB before that, without asking anybody
const edits = 120;
const cell = { row: 1, column: 1 };

// AddressSanitizer keeps freed memory back, which is no growth of the service.
process.env.ASAN_OPTIONS = `${process.env.ASAN_OPTIONS ?? ""}:quarantine_size_mb=1`;

journey("a frozen browser costs the service little, and the others nothing", async (scene) => {
  // On a large map each edit sends the whole map to each page. idle_s is long, so that the frozen page stays connected.
  const system = await scene.services({
    robots: 2,
    sim: { map: { yaml: writeBigMap(scene.folder) }, camera: { mode: "egl", stream: true } },
    planner: { method: "greedy", first_guidance_timeout_s: 0.2 },
    operator: { console: { idle_s: 600 } },
  });
  const server = await launchServer();
  scene.later(() => server.close());
  const frozen = await scene.open(system.url, { name: "Frozen", browser: await connect(server) });
  const lively = await scene.open(system.url, { name: "Lively" });
  await lively.begin(texts.watch); // nobody has control, so the fast editor may edit
  await lively.moves("r1");
  for (const page of [frozen, lively]) await page.opensCamera("r1");
  await until("frames come", () => frozen.received.frames > 0 && lively.received.frames > 0);

  const processes = familyOf(server.process().pid);
  const signal = (name) => signalAll(processes, name);
  scene.later(() => signal("SIGCONT"));
  signal("SIGSTOP");
  const { port } = new URL(system.url);
  const operator = system.pidOf("operator");
  const before = memoryOf(operator);
  const frames = lively.received.frames;
  const editor = await FastEditor.of(lively);
  const { revision } = lively.received.belief();
  await editor.toggles(cell, edits, revision);
  await lively.waitsForRevision(revision + BigInt(edits));

  // Each edit is 45 kB per page. The frozen page gets no more than it shows.
  const waiting = waitingFor(port);
  assert.ok(waiting < mostWaiting, `${waiting} bytes wait for the frozen one`);
  const grown = memoryOf(operator) - before;
  assert.ok(grown < mostGrowth, `the service grew by ${grown} KiB`);

  assert.ok(lively.received.frames > frames, "the other one sees its streams");
  await lively.link("live");
  await lively.toggles({ row: 2, column: 2 });

  // Once resumed, it receives the newest state, but not the updates in between.
  signal("SIGCONT");
  await until(
    "the frozen one catches up",
    () => frozen.received.belief().revision === lively.received.belief().revision,
    {
      within: 40,
      now: () => [frozen.received.belief().revision, lively.received.belief().revision],
    },
  );
});

/** Bytes that the kernel buffers for the slowest client of the service on `port`. */
function waitingFor(port) {
  const local = `0100007F:${Number(port).toString(16).toUpperCase().padStart(4, "0")}`;
  const sockets = readFileSync("/proc/net/tcp", "utf8")
    .split("\n")
    .map((line) => line.trim().split(/\s+/));
  const queues = sockets
    .filter(([, address]) => address === local)
    .map((words) => Number.parseInt(words[4].split(":")[0], 16));
  return Math.max(0, ...queues);
}
