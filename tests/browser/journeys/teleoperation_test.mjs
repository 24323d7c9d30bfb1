import assert from "node:assert/strict";
import { journey } from "../support/journey.mjs";
import { numberOf } from "../support/protocol.mjs";
import { teleoperation } from "../support/scene.mjs";
import { texts } from "../support/texts.mjs";
import { stays, until } from "../support/wait.mjs";

const stop = numberOf("DriveAction", "DRIVE_STOP");
const left = numberOf("DriveAction", "DRIVE_TURN_LEFT");

/** Drives, then ends the driving by `release`: the page must request a stop, and the robot must stand still. */
async function stopsAfter(page, release) {
  const asked = page.received.requests("drive").length;
  await page.page.keyboard.down("ArrowLeft");
  await turns(page, asked);
  await release();
  await until(
    "the page requests a stop",
    () => page.received.requests("drive").at(-1).body.value.action === stop,
  );
  await page.page.locator(".drive").getByText(texts.standing).waitFor();
  await page.comesToRest("r1");
  await page.page.keyboard.up("ArrowLeft");
  const now = page.received.requests("drive").length;
  await stays(
    "nothing more is requested",
    0.6,
    () => page.received.requests("drive").length === now,
  );
}

/** Waits for several actions, so that the key was held, not just pressed. */
async function turns(page, asked) {
  const { heading } = page.received.robot("r1");
  await until(
    "several actions are sent",
    () => page.received.requests("drive").length >= asked + 3,
  );
  assert.equal(page.received.requests("drive").at(-1).body.value.action, left);
  await until("the robot turns", () => page.received.robot("r1").heading !== heading);
  await page.page.locator(".drive").getByText(texts.turnsLeft).waitFor();
}

journey("driving stops with the key, with the focus, and with the page", async (scene) => {
  const system = await scene.demo(...teleoperation);
  const page = await scene.open(system.url);
  await page.begin();
  await page.reads(texts.driveHint);
  await page.reads(texts.needsDriver);
  await page.page.getByRole("img", { name: texts.liveView("r1") }).waitFor();
  await until("frames come before anything moves", () => page.received.frames > 0);
  assert.equal(page.received.robot("r1").lowLevelSteps, 0n);

  await stopsAfter(page, () => page.page.keyboard.up("ArrowLeft"));
  await until("a driven robot needs no path", () =>
    page.received.all("attention")[0].items.every(({ robot }) => robot !== "r1"),
  );
  await stopsAfter(page, () => page.page.evaluate(() => window.dispatchEvent(new Event("blur"))));
  // After a click on the map the arrows still drive. A context menu would hide the key's release from the page.
  await page.map.click({ position: { x: 5, y: 5 } });
  await stopsAfter(page, () => page.page.locator(".drive").click({ button: "right" }));

  // A tool that edits takes over the arrow keys until Escape.
  await page.map.click({ position: { x: 5, y: 5 } });
  await stopsAfter(page, () => page.page.keyboard.up("ArrowLeft"));
  await page.press("w");
  await page.reads(texts.editing);
  const before = page.received.requests("drive").length;
  await page.press("ArrowLeft");
  await page.page
    .locator(".map-status output")
    .filter({ hasText: /^Row/ })
    .waitFor({ state: "attached" });
  assert.equal(page.received.requests("drive").length, before);
  await page.press("Escape");
  await stopsAfter(page, () => page.page.keyboard.up("ArrowLeft"));

  // A stopped robot cannot be driven.
  await page.press("s");
  await page.page.locator(".drive").getByText(texts.isStopped).waitFor();
  const asked = page.received.requests("drive").length;
  await page.press("ArrowLeft");
  await page.reads(texts.cannotDriveStopped);
  assert.equal(page.received.requests("drive").length, asked);
});

journey("a finger drives while it rests, on a tablet", async (scene) => {
  const system = await scene.demo(...teleoperation);
  const tablet = { hasTouch: true, isMobile: true, viewport: { width: 1024, height: 768 } };
  const page = await scene.open(system.url, tablet);
  await page.begin();
  await page.reads(texts.driveHint); // a touch before the robot has confirmed that it is resumed drives nothing
  const button = page.button(texts.drive("left"));
  await button.scrollIntoViewIfNeeded();
  const { x, y, width, height } = await button.boundingBox();
  assert.ok(Math.min(width, height) >= 40, "large enough for a finger");
  const client = await page.page.context().newCDPSession(page.page);
  const touch = (type, touchPoints) =>
    client.send("Input.dispatchTouchEvent", { type, touchPoints });
  await touch("touchStart", [{ x: x + width / 2, y: y + height / 2 }]);
  await turns(page, 0);
  await touch("touchEnd", []);
  await until(
    "the page requests a stop",
    () => page.received.requests("drive").at(-1).body.value.action === stop,
  );
  await page.comesToRest("r1");
});

journey("driving stops when the socket closes, and does not restart by itself", async (scene) => {
  const system = await scene.demo(...teleoperation);
  scene.expectConnectionTrouble();
  const witness = await scene.open(system.url, { name: "Witness" });
  const line = await scene.line(system.url);
  const page = await scene.open(line.url);
  await page.begin();
  await page.reads(texts.driveHint);
  await page.page.keyboard.down("ArrowLeft");
  await turns(page, 0);
  line.cut();
  await page.link("lost");
  // An action is valid for one second of simulation time at most.
  await witness.comesToRest("r1");
  const { lowLevelSteps } = witness.received.robot("r1");
  line.mend();
  await page.link("live");
  // The key is still down, but driving starts with a new press only.
  const asked = page.received.requests("drive").length;
  await stays(
    "the robot stands",
    1.5,
    () => witness.received.robot("r1").lowLevelSteps === lowLevelSteps,
  );
  assert.equal(page.received.requests("drive").length, asked);
  await page.page.keyboard.up("ArrowLeft");
});
