import assert from "node:assert/strict";
import { journey } from "../support/journey.mjs";
import { stays, until } from "../support/wait.mjs";

const both = ["r1", "r2"];
/** Robots do not wait for anybody. */
const restless = { first_guidance_timeout_s: 0.2, answer_timeout_s: 0.2 };

journey("one key stops all robots, and they stand until somebody lets them go", async (scene) => {
  const system = await scene.services({ robots: 2, planner: restless });
  const page = await scene.open(system.url);
  await page.begin();
  await Promise.all(both.map((robot) => page.moves(robot)));

  await page.press("Shift+Escape");
  for (const robot of both) await page.card(robot).getByText("■ stopped").waitFor();
  await Promise.all(both.map((robot) => page.comesToRest(robot)));
  const places = both.map((robot) => page.cellOf(robot));
  const steps = both.map((robot) => page.told.robot(robot).lowLevelSteps);
  await stays("stopped robots stand", 2, () =>
    both.every(
      (robot, i) =>
        page.cellOf(robot) === places[i] && page.told.robot(robot).lowLevelSteps === steps[i],
    ),
  );

  await page.press("Shift+G");
  await page.card("r1").getByText("■ stopped").waitFor({ state: "hidden" });
  await until("somebody moves again", () =>
    both.some((robot, i) => page.cellOf(robot) !== places[i]),
  );
});

journey("a second operator takes over with a reason, which the first one reads", async (scene) => {
  const system = await scene.services({ robots: 2 });
  const ada = await scene.open(system.url, { name: "Ada" });
  await ada.begin();
  await ada.button(/You control r1/).waitFor();
  const ben = await scene.open(system.url, { name: "Ben" });
  await ben.button("Ada controls r1: take over").click();
  const dialog = ben.dialog("Take over?");
  const take = dialog.getByRole("button", { name: "Take over" });
  assert.equal(await take.isDisabled(), true, "not without a reason");
  await dialog.getByLabel("Reason").fill("Ada has a phone call");
  await take.click();
  await ben.button(/You control r1/).waitFor();
  await ada.button("Ben controls r1: take over").waitFor();
  assert.match(
    (await ada.card("r1").locator(".choose").getAttribute("title")) ?? "",
    /Ada has a phone call/,
  );

  // What is Ben's, Ada can only stop.
  await ada.card("r1").getByRole("button", { name: "Stop r1" }).click();
  await ben.card("r1").getByText("■ stopped").waitFor();
  assert.equal(ben.told.control("r1").stoppedBy, ada.told.welcome.client);
  await ada.button("Log").click();
  await ada.panel("Command log").getByText("Ada has a phone call").waitFor();
});

const tokens = { observer: "observer-token-0123456789", operator: "operator-token-0123456789" };

journey("an observer sees all and may only stop", async (scene) => {
  const system = await scene.services({
    robots: 1,
    planner: restless,
    operator: { console: { tokens } },
  });
  const guide = await scene.open(`${system.url}#token=${tokens.operator}`, { name: "Guide" });
  await guide.begin();
  const watcher = await scene.open(`${system.url}#token=${tokens.observer}`, { name: "Watcher" });
  assert.equal(new URL(watcher.page.url()).hash, "", "the token leaves the address");
  await watcher.moves("r1");
  await watcher.page.locator(".latency").getByText("observer").waitFor();
  assert.equal(await watcher.button(/Take control|take over/).count(), 0);
  assert.equal(await watcher.button(/Go all/).isDisabled(), true);

  const { revision } = watcher.told.belief();
  assert.equal(await watcher.button(/Wall|Erase|Rectangle|Path|Undo/).count(), 0, "no tools");
  await watcher.press("w");
  await watcher.pointAt({ row: 1, column: 1 });
  await watcher.page.mouse.down();
  await watcher.page.mouse.up();
  assert.deepEqual(watcher.told.asked, []);

  await watcher.button(/Stop all/).click();
  await guide.card("r1").getByText("■ stopped").waitFor();
  assert.equal(await watcher.button("Go r1").isDisabled(), true);
  await watcher.press("g");
  const refused = await until("the service refuses Go", () =>
    watcher.told.replies.find(({ accepted }) => !accepted),
  );
  assert.match(refused.reason, /observer/);
  assert.equal(guide.told.control("r1").stopped, true);
  assert.equal(guide.told.belief().revision, revision);
});

journey("a wrong token shows nothing, and says so", async (scene) => {
  const system = await scene.services({ robots: 1, operator: { console: { tokens } } });
  const page = await scene.openOnly(`${system.url}#token=wrong-token-0123456789`);
  await page.reads(/the token is not known/);
  assert.equal(await page.page.locator(".fleet-card").count(), 0);
  assert.deepEqual(page.told.all("robot"), []);
});
