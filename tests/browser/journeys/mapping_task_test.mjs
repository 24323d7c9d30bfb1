import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { journey } from "../support/journey.mjs";
import { numberOf } from "../support/protocol.mjs";
import { until } from "../support/wait.mjs";

const finished = numberOf("TaskPhase", "PHASE_FINISHED");

async function regionsOf({ page }) {
  const labels = (regions) => regions.map((region) => region.getAttribute("aria-label"));
  return (await page.getByRole("region").evaluateAll(labels)).sort();
}

/** In the page: of an image. */
function pixelsOf(image) {
  const canvas = document.createElement("canvas");
  canvas.width = image.naturalWidth;
  canvas.height = image.naturalHeight;
  canvas.getContext("2d").drawImage(image, 0, 0);
  return canvas.toDataURL();
}

/** Ask for pictures until the maze may be finished. */
async function seeAllGoals(page) {
  const next = page.button(/Next picture/);
  const finish = page.button("Finish this maze");
  for (;;) {
    await next.waitFor();
    if (await finish.isVisible()) return;
    const { length } = page.told.pictures("r1");
    await page.press("n");
    await until("the next picture comes", () => page.told.pictures("r1").length > length);
  }
}

journey("a participant maps one maze after the other at one page", async (scene) => {
  scene.expectConnectionTrouble(); // the service leaves between two mazes
  const task = await scene.mappingTask("--participant", "P07", "--maze-seed", "7,9");
  const page = await scene.openOnly(task.url);

  await page.dialog("Maze 1 of 2").waitFor();
  await page.dialog("Maze 1 of 2").getByRole("button", { name: "Begin" }).click();
  await page.button(/Next picture/).waitFor();
  const picture = page.page.getByRole("img", { name: "Picture 1 of r1" });
  const firstMaze = await picture.evaluate(pixelsOf);
  await page.toggles({ row: 6, column: 6 });
  await page.button("Undo").click(); // and back
  await page.waitsForRevision(2n);
  assert.deepEqual(await regionsOf(page), ["Map of w1", "Pictures", "Task"], "no queue, no alerts");
  assert.equal(await page.page.getByRole("navigation").count(), 0, "no fleet strip");
  assert.equal(await page.button(/^Path/).count(), 0, "no paths");
  for (const secret of ["seen", "plan", "search", "prediction", "truth"]) {
    assert.equal(page.told.newest(secret, "r1") ?? page.told.newest(secret, "w1"), undefined);
  }

  await seeAllGoals(page);
  await page.button("Finish this maze").click();
  await page.button("Yes, finish").click();
  await page.reads(/Maze 1 is finished: 0 % of the map's mistakes corrected/);
  assert.equal(page.told.newest("task").phase, finished);

  await page.dialog("Maze 2 of 2").waitFor();
  await page.reads("Maze 1: you corrected 0 % of the map's mistakes.");
  assert.equal(await page.button("Undo").isDisabled(), true, "nothing of maze 1 can be undone");
  await page.dialog("Maze 2 of 2").getByRole("button", { name: "Begin" }).click();
  await page.button(/Next picture/).waitFor();
  assert.notEqual(await picture.evaluate(pixelsOf), firstMaze, "a picture of this maze");
  const result = JSON.parse(readFileSync(join(task.folder, "result.json"), "utf8"));
  assert.equal(result.mazes_finished, 1);
  assert.equal(result.mazes[0].edits, 2);
});
