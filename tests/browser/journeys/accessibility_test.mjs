import assert from "node:assert/strict";
import { finds } from "../support/axe.mjs";
import { journey } from "../support/journey.mjs";
import { texts } from "../support/texts.mjs";
import { until } from "../support/wait.mjs";

journey("axe finds nothing serious in any state of the page, dark or light", async (scene) => {
  const system = await scene.services({
    robots: 2,
    planner: { first_guidance_timeout_s: 0.2, search: { mapping_value: 4 } },
  });
  const page = await scene.open(system.url, { colorScheme: "dark" });
  await page.dialog(texts.ready).waitFor();
  await finds(page, "start dialog");

  await page.begin();
  await until("a robot sends a picture", () => page.received.all("snapshot").length > 0);
  await page.chooses(page.received.all("snapshot")[0].robot);
  await page.page.getByRole("img", { name: texts.anyPicture }).waitFor();
  await page.button(texts.workload).click();
  await page.button(texts.log).click();
  await finds(page, "supervising");

  await page.tool(texts.path).click();
  await page.button(texts.layers).click();
  await finds(page, "path tool and layers");
  await page.press("Escape");

  const size = page.page.viewportSize();
  await page.page.setViewportSize({ width: 800, height: 600 });
  await finds(page, "small window");
  const { height } = await page.map.boundingBox();
  assert.ok(height >= 320, `the map keeps room for drawing, it has ${height} px`);
  await page.page.setViewportSize(size);

  await page.press("?");
  await page.dialog(texts.help).waitFor();
  await finds(page, "help");
  await page.press("Escape");

  await page.press("Shift+Escape");
  await page.card("r1").getByText(texts.stopped).waitFor();
  await system.kill("planner");
  await page.panel(texts.alerts).locator("li").first().waitFor();
  await finds(page, "alerts");

  const other = await scene.open(system.url, { colorScheme: "dark" });
  await other.button(texts.anyTakeOver).click();
  await other.dialog(texts.takeOverDialog).waitFor();
  await finds(other, "take over");
});

journey("axe finds nothing serious on a participant's page", async (scene) => {
  const task = await scene.mappingTask("--participant", "P07", "--maze-seed", "7");
  const page = await scene.openOnly(task.url, { colorScheme: "dark" });
  const begin = page.dialog(texts.maze(1, 1)).getByRole("button", { name: texts.begin });
  await begin.waitFor();
  await finds(page, "begin dialog");
  await begin.click();
  await page.page.getByRole("img", { name: texts.firstPicture("r1") }).waitFor();
  await finds(page, "mapping");
  await page.press("?");
  await page.dialog(texts.taskHelp).waitFor();
  await finds(page, "help of the task");
});
