import assert from "node:assert/strict";
import { journey } from "../support/journey.mjs";
import { texts } from "../support/texts.mjs";
import { settles, stays, until } from "../support/wait.mjs";

/** Robots do not wait for answers. */
const restless = { first_guidance_timeout_s: 0.2, answer_timeout_s: 0.2 };

journey("a camera sends while somebody looks, and its bytes count apart", async (scene) => {
  const system = await scene.services({ robots: 3, planner: restless });
  const page = await scene.open(system.url);
  await page.begin();
  const bytes = (robot) => page.received.robot(robot).cameraBytes;
  await page.opensCamera("r1");
  await page.opensCamera("r3");
  await until("its bytes are counted", () => bytes("r1") > 0n && bytes("r3") > 0n);
  assert.equal(bytes("r2"), 0n);
  const pictures = page.received.snapshots("r1").length;
  assert.ok(page.received.robot("r1").images <= BigInt(pictures + 1), "frames are no pictures");

  await page.button(texts.enlarge("r1")).click();
  await page.panel(texts.largeView).waitFor();
  await page.press("Escape");
  await page.panel(texts.largeView).waitFor({ state: "hidden" });

  for (const robot of ["r1", "r3"]) await page.button(texts.closeCamera(robot)).click();
  await settles("no frame comes any more", 0.7, () => page.received.frames);
  const sent = bytes("r1");
  await stays("nothing is sent", 1, () => bytes("r1") === sent);
});

journey("the time line shows what was, keeps notes, and links to a moment", async (scene) => {
  const system = await scene.services({ robots: 2, planner: restless });
  const page = await scene.open(system.url, { permissions: ["clipboard-read", "clipboard-write"] });
  await page.begin();
  await until("pictures come", () => page.received.snapshots("r1").length > 1);
  await page.press("m");
  await page.dialog(texts.noteDialog).getByLabel(texts.noteText).fill("the door was open");
  await page.press("Enter");
  await until("the note is in the log", () =>
    page.received.all("event").some(({ text }) => text === "the door was open"),
  );
  await page.page.locator(".time-bar line.of-note").waitFor({ state: "attached" });

  await page.edits({ row: 1, column: 1 });
  const edits = page.received.requests("edit").length;
  await page.looksBack(0.1);
  const clock = await page.page.locator(".run-clock").textContent();
  await page.moves("r1");
  assert.equal(await page.page.locator(".run-clock").textContent(), clock, "the past stands still");
  await page.press("w");
  await page.map.click({ position: { x: 200, y: 200 } });
  await stays("the past is not edited", 1, () => page.received.requests("edit").length === edits);
  await page.press("Shift+Escape");
  await until("a stop works all the same", () => page.received.control("r1")?.stopped);

  await page.panel(texts.timeLine).getByTitle(texts.copyLink).click();
  await page.reads(texts.copied);
  const link = await page.page.evaluate(() => navigator.clipboard.readText());
  assert.match(link, /#run=.*&moment=\d+\.\d$/);
  await page.panel(texts.timeLine).getByRole("button", { name: texts.live, exact: true }).click();
  await until(
    "the page shows the present again",
    async () => (await page.page.locator(".run-clock").textContent()) !== clock,
  );

  const timeLine = page.panel(texts.timeLine);
  await timeLine.getByTitle(texts.clip).click();
  await page.press("Shift+G");
  await page.moves("r1");
  const saving = page.page.waitForEvent("download");
  await timeLine.getByTitle(texts.saveClip).click();
  assert.match((await saving).suggestedFilename(), /\.webm$/);
});

journey("the world is shown in three dimensions, and the map stays as it was", async (scene) => {
  const system = await scene.services({ robots: 2, planner: restless });
  const page = await scene.open(system.url);
  await page.begin();
  await until("a picture comes", () => page.received.snapshots("r1").length > 0);
  await page.press("3");
  await page.page.locator(".map-solid canvas").waitFor();
  await page.page.getByRole("img", { name: texts.solid }).waitFor();
  await page.moves("r1");
  await page.press("3");
  await page.page.locator(".map-solid").waitFor({ state: "hidden" });
  await page.edits({ row: 1, column: 1 });
});

journey("a link to a moment opens the recording there", async (scene) => {
  const system = await scene.replay("--robots", "1", "--seed", "3", "--speed", "8");
  const page = await scene.open(system.url);
  const { began, duration } = await until("the recording is there", () =>
    page.received.newest("playback"),
  );
  const linked = await scene.open(
    `${system.url}/#run=any&moment=${(began + duration / 2).toFixed(1)}`,
  );
  await until("it is half way", () => {
    return linked.received.newest("playback").position > duration / 2 - 0.3;
  });

  // The map stays where it is, as the scene checks.
  system.signal("SIGSTOP");
  await linked.link("stale");
  system.signal("SIGCONT");
  await linked.link("live");
});
