import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { journey } from "../support/journey.mjs";
import { until } from "../support/wait.mjs";

/** The robot goes by itself; its pictures are answered until it has reached all goals. */
async function letItReachAllGoals(page) {
  const finish = page.button("Finish this part");
  const answer = page.button(/Nothing new in this picture/);
  await until(
    "the robot reaches all goals",
    async () => {
      if (await answer.isVisible()) await page.press("x");
      return finish.isVisible();
    },
    { within: 60, every: 0.3, now: () => page.told.newest("task") },
  );
}

journey("a participant has one method of a study after the other at one page", async (scene) => {
  scene.expectConnectionTrouble(); // the service leaves between two parts
  const methods = ["--methods", "ig-mcts,teleop", "--order", "1", "--maze-seed", "7,9"];
  const study = await scene.liveStudy("--participant", "P07", ...methods);
  const page = await scene.openOnly(study.url);

  await page.dialog("Part 1 of 2").getByText("The robot drives by itself.").waitFor();
  await page.dialog("Part 1 of 2").getByRole("button", { name: "Begin" }).click();
  await page.button(/^Path/).waitFor();
  await letItReachAllGoals(page);
  await page.button("Finish this part").click();
  await page.button("Yes, finish").click();

  await page.dialog("Part 2 of 2").getByText("You drive the robot").waitFor();
  await page.dialog("Part 2 of 2").getByRole("button", { name: "Begin" }).click();
  await page.page.getByRole("img", { name: "Live view of r1" }).waitFor();
  assert.equal(await page.button(/^Path/).count(), 0, "no paths in teleoperation");
  await page.reads(/Hold the arrow keys to drive/);
  for (const secret of ["seen", "plan", "search", "prediction", "truth"]) {
    assert.equal(page.told.newest(secret, "r1") ?? page.told.newest(secret, "w1"), undefined);
  }
  const result = JSON.parse(readFileSync(join(study.folder, "result.json"), "utf8"));
  assert.equal(result.mazes[0].method, "ig-mcts");
  assert.equal(result.mazes_finished, 1);
});
