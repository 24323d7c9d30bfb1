import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { journey } from "../support/journey.mjs";
import { numberOf } from "../support/protocol.mjs";
import { texts } from "../support/texts.mjs";
import { until } from "../support/wait.mjs";

const finished = numberOf("TaskPhase", "PHASE_FINISHED");

async function regionsOf({ page }) {
  const labels = (regions) => regions.map((region) => region.getAttribute("aria-label"));
  return (await page.getByRole("region").evaluateAll(labels)).sort();
}

/** Runs in the page: the pixels of an image. */
function pixelsOf(image) {
  const canvas = document.createElement("canvas");
  canvas.width = image.naturalWidth;
  canvas.height = image.naturalHeight;
  canvas.getContext("2d").drawImage(image, 0, 0);
  return canvas.toDataURL();
}

/** Requests pictures until the maze may be finished. */
async function seeAllGoals(page) {
  const next = page.button(texts.nextPicture);
  const finish = page.button(texts.finishMaze);
  for (;;) {
    await next.waitFor();
    if (await finish.isVisible()) return;
    const { length } = page.received.snapshots("r1");
    await page.press("n");
    await until("the next picture comes", () => page.received.snapshots("r1").length > length);
  }
}

journey("a participant maps one maze after the other on one page", async (scene) => {
  scene.expectConnectionTrouble(); // the service restarts between two mazes
  const task = await scene.mappingTask("--participant", "P07", "--maze-seed", "7,9");
  const page = await scene.openOnly(task.url);

  await page.dialog(texts.maze(1, 2)).waitFor();
  await page.dialog(texts.maze(1, 2)).getByRole("button", { name: texts.begin }).click();
  await page.button(texts.nextPicture).waitFor();
  const picture = page.page.getByRole("img", { name: texts.firstPicture("r1") });
  const firstMaze = await picture.evaluate(pixelsOf);
  await page.toggles({ row: 6, column: 6 });
  await page.button(texts.undo).click(); // and back
  await page.waitsForRevision(2n);
  assert.deepEqual(await regionsOf(page), texts.taskRegions, "no queue, no alerts");
  assert.equal(await page.page.getByRole("navigation").count(), 0, "no fleet strip");
  assert.equal(await page.button(texts.anyPath).count(), 0, "no paths");
  for (const secret of ["seen", "plan", "search", "prediction", "truth"]) {
    assert.equal(
      page.received.newest(secret, "r1") ?? page.received.newest(secret, "w1"),
      undefined,
    );
  }

  await seeAllGoals(page);
  await page.button(texts.finishMaze).click();
  await page.button(texts.yesFinish).click();
  await page.reads(texts.mazeResult(1));
  assert.equal(page.received.newest("task").phase, finished);

  await page.dialog(texts.maze(2, 2)).waitFor();
  await page.reads(texts.earlierResult);
  assert.equal(await page.button(texts.undo).isDisabled(), true, "nothing of maze 1 can be undone");
  await page.dialog(texts.maze(2, 2)).getByRole("button", { name: texts.begin }).click();
  await page.button(texts.nextPicture).waitFor();
  assert.notEqual(await picture.evaluate(pixelsOf), firstMaze, "a picture of this maze");
  const result = JSON.parse(readFileSync(join(task.folder, "result.json"), "utf8"));
  assert.equal(result.mazes_finished, 1);
  assert.equal(result.steps[0].edits, 2);
});
