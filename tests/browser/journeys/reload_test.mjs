import assert from "node:assert/strict";
import { journey } from "../support/journey.mjs";
import { until } from "../support/wait.mjs";

journey("a reload keeps all that was done, and the control of robots", async (scene) => {
  const system = await scene.services({ robots: 2 });
  const page = await scene.open(system.url, { name: "Ada" });
  await page.begin();
  await page.button("Log").click();
  await page.press("d"); // theme: dark
  await page.toggles({ row: 1, column: 1 });
  await page.press("s");
  await page.card("r1").getByText("■ stopped").waitFor();
  const { revision } = page.told.belief();
  const wall = page.told.isWall({ row: 1, column: 1 });
  const events = page.told.all("event").length;
  const { client } = page.told.welcome;

  await page.page.reload();
  await page.isReady();

  assert.equal(page.told.welcome.client, client, "a reloaded page is the same client");
  assert.equal(page.told.control("r2").holder, client, "which has control still");
  assert.equal(page.told.belief().revision, revision);
  assert.equal(page.told.isWall({ row: 1, column: 1 }), wall);
  assert.equal(page.told.belief().editedBy, client);
  await page.card("r1").getByText("■ stopped").waitFor();
  assert.equal(page.told.control("r2").stopped, false);
  assert.ok(page.told.all("event").length >= events, "the command log is whole");
  await page.panel("Command log").getByText(/edit/i).first().waitFor();
  assert.equal(await page.page.locator("html").getAttribute("data-theme"), "dark");
  assert.equal(await page.dialog(/ready/).count(), 0, "who has begun is not asked again");
  await until("the log names who did it", () =>
    page.told.all("event").some((event) => event.client === client),
  );
});
