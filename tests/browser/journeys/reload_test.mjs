import assert from "node:assert/strict";
import { journey } from "../support/journey.mjs";
import { texts } from "../support/texts.mjs";
import { until } from "../support/wait.mjs";

journey("a reload keeps all edits and the control of robots", async (scene) => {
  const system = await scene.services({ robots: 2 });
  const page = await scene.open(system.url, { name: "Ada" });
  await page.begin();
  await page.button(texts.log).click();
  await page.press("d"); // theme: dark
  await page.toggles({ row: 1, column: 1 });
  await page.press("s");
  await page.card("r1").getByText(texts.stopped).waitFor();
  const { revision } = page.received.belief();
  const wall = page.received.isWall({ row: 1, column: 1 });
  const events = page.received.all("event").length;
  const { client } = page.received.welcome;

  await page.page.reload();
  await page.isReady();

  assert.equal(page.received.welcome.client, client, "a reloaded page is the same client");
  assert.equal(page.received.control("r2").holder, client, "which has control still");
  assert.equal(page.received.belief().revision, revision);
  assert.equal(page.received.isWall({ row: 1, column: 1 }), wall);
  assert.equal(page.received.belief().editedBy, client);
  await page.card("r1").getByText(texts.stopped).waitFor();
  assert.equal(page.received.control("r2").stopped, false);
  assert.ok(page.received.all("event").length >= events, "the command log is whole");
  await page.panel(texts.commandLog).getByText(/edit/i).first().waitFor();
  assert.equal(await page.page.locator("html").getAttribute("data-theme"), "dark");
  assert.equal(await page.dialog(texts.ready).count(), 0, "who has begun is not asked again");
  await until("the log names who did it", () =>
    page.received.all("event").some((event) => event.client === client),
  );
});
