import assert from "node:assert/strict";
import { journey } from "../support/journey.mjs";
import { numberOf } from "../support/protocol.mjs";
import { teleoperation } from "../support/scene.mjs";
import { stays, until } from "../support/wait.mjs";

const stop = numberOf("DriveAction", "DRIVE_STOP");
const left = numberOf("DriveAction", "DRIVE_TURN_LEFT");

/** Every way of driving ends in the same: a stop was asked for, and the robot stands. */
async function stopsAfter(page, release) {
  const asked = page.told.requests("drive").length;
  await page.page.keyboard.down("ArrowLeft");
  await turns(page, asked);
  await release();
  await until(
    "the page asks for a stop",
    () => page.told.requests("drive").at(-1).body.value.action === stop,
  );
  await page.page.locator(".drive").getByText("stands").waitFor();
  await page.comesToRest("r1");
  await page.page.keyboard.up("ArrowLeft");
  const now = page.told.requests("drive").length;
  await stays("nothing more is asked for", 0.6, () => page.told.requests("drive").length === now);
}

/** Several actions: the key is held, not pressed once. */
async function turns(page, asked) {
  const { heading } = page.told.robot("r1");
  await until("several actions are sent", () => page.told.requests("drive").length >= asked + 3);
  assert.equal(page.told.requests("drive").at(-1).body.value.action, left);
  await until("the robot turns", () => page.told.robot("r1").heading !== heading);
  await page.page.locator(".drive").getByText("← left").waitFor();
}

journey("driving stops with the key, with the focus, and with the page", async (scene) => {
  const system = await scene.demo(...teleoperation);
  const page = await scene.open(system.url);
  await page.begin();
  await page.reads(/Hold the arrow keys to drive/);
  await page.reads(/waits to be driven/);
  await page.page.getByRole("img", { name: "Live view of r1" }).waitFor();
  await until("frames come before anything moves", () => page.told.frames > 0);
  assert.equal(page.told.robot("r1").lowLevelSteps, 0n);

  await stopsAfter(page, () => page.page.keyboard.up("ArrowLeft"));
  await until("a driven robot needs no path", () =>
    page.told.all("attention")[0].items.every(({ robot }) => robot !== "r1"),
  );
  await stopsAfter(page, () => page.page.evaluate(() => window.dispatchEvent(new Event("blur"))));
  // After a click on the map the arrows still drive; a context menu would keep the key's release from the page.
  await page.map.click({ position: { x: 5, y: 5 } });
  await stopsAfter(page, () => page.page.locator(".drive").click({ button: "right" }));

  // A click on the map changes nothing of that; a tool that edits does, until Escape.
  await page.map.click({ position: { x: 5, y: 5 } });
  await stopsAfter(page, () => page.page.keyboard.up("ArrowLeft"));
  await page.press("w");
  await page.reads(/You edit the map/);
  const before = page.told.requests("drive").length;
  await page.press("ArrowLeft");
  await page.page
    .locator(".map-status output")
    .filter({ hasText: /^Row/ })
    .waitFor({ state: "attached" });
  assert.equal(page.told.requests("drive").length, before);
  await page.press("Escape");
  await stopsAfter(page, () => page.page.keyboard.up("ArrowLeft"));

  // Without a key nothing is driven; stopping the robot forbids it.
  await page.press("s");
  await page.page
    .locator(".drive")
    .getByText(/r1 is stopped/)
    .waitFor();
  const asked = page.told.requests("drive").length;
  await page.press("ArrowLeft");
  await page.reads(/No driving: r1 is stopped/);
  assert.equal(page.told.requests("drive").length, asked);
});

journey(
  "driving stops when the socket closes, and does not begin again by itself",
  async (scene) => {
    const system = await scene.demo(...teleoperation);
    scene.expectConnectionTrouble();
    const witness = await scene.open(system.url, { name: "Witness" });
    const line = await scene.line(system.url);
    const page = await scene.open(line.url);
    await page.begin();
    await page.reads(/Hold the arrow keys to drive/);
    await page.page.keyboard.down("ArrowLeft");
    await turns(page, 0);
    line.cut();
    await page.link("lost");
    // An action counts for one second of simulation time at most.
    await witness.comesToRest("r1");
    const { lowLevelSteps } = witness.told.robot("r1");
    line.mend();
    await page.link("live");
    // The key is still down, and keeps repeating nothing: driving begins with a new press only.
    const asked = page.told.requests("drive").length;
    await stays(
      "the robot stands",
      1.5,
      () => witness.told.robot("r1").lowLevelSteps === lowLevelSteps,
    );
    assert.equal(page.told.requests("drive").length, asked);
    await page.page.keyboard.up("ArrowLeft");
  },
);
