import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { journey } from "../support/journey.mjs";
import { texts } from "../support/texts.mjs";
import { until } from "../support/wait.mjs";

/** The robot drives by itself. Answers its pictures until it has reached all goals. */
async function letItReachAllGoals(page) {
  const finish = page.button(texts.finishPart);
  const answer = page.button(texts.nothingNewInPicture);
  await until(
    "the robot reaches all goals",
    async () => {
      if (await answer.isVisible()) await page.press("x");
      return finish.isVisible();
    },
    { within: 60, every: 0.3, now: () => page.received.newest("task") },
  );
}

journey("a participant uses one method of a study after the other on one page", async (scene) => {
  scene.expectConnectionTrouble(); // the service restarts between two parts
  const methods = ["--methods", "ig-mcts,teleop", "--order", "1", "--maze-seed", "7,9"];
  const study = await scene.liveStudy("--participant", "P07", ...methods);
  const page = await scene.openOnly(study.url);

  await page.dialog(texts.part(1, 2)).getByText(texts.drivesByItself).waitFor();
  await page.dialog(texts.part(1, 2)).getByRole("button", { name: texts.begin }).click();
  await page.button(texts.anyPath).waitFor();
  await letItReachAllGoals(page);
  await page.button(texts.finishPart).click();
  await page.button(texts.yesFinish).click();

  await page.dialog(texts.part(2, 2)).getByText(texts.youDrive).waitFor();
  await page.dialog(texts.part(2, 2)).getByRole("button", { name: texts.begin }).click();
  await page.page.getByRole("img", { name: texts.liveView("r1") }).waitFor();
  assert.equal(await page.button(texts.anyPath).count(), 0, "no paths in teleoperation");
  await page.reads(texts.driveHint);
  for (const secret of ["seen", "plan", "search", "prediction", "truth"]) {
    assert.equal(
      page.received.newest(secret, "r1") ?? page.received.newest(secret, "w1"),
      undefined,
    );
  }
  const result = JSON.parse(readFileSync(join(study.folder, "result.json"), "utf8"));
  assert.equal(result.mazes[0].method, "ig-mcts");
  assert.equal(result.mazes_finished, 1);
});
