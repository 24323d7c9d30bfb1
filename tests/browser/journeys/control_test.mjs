import assert from "node:assert/strict";
import { journey } from "../support/journey.mjs";
import { texts } from "../support/texts.mjs";
import { stays, until } from "../support/wait.mjs";

const both = ["r1", "r2"];
/** Robots do not wait for answers. */
const restless = { first_guidance_timeout_s: 0.2, answer_timeout_s: 0.2 };

journey("one key stops all robots until somebody resumes them", async (scene) => {
  const system = await scene.services({ robots: 2, planner: restless });
  const page = await scene.open(system.url);
  await page.begin();
  await Promise.all(both.map((robot) => page.moves(robot)));

  await page.press("Shift+Escape");
  for (const robot of both) await page.card(robot).getByText(texts.stopped).waitFor();
  await Promise.all(both.map((robot) => page.comesToRest(robot)));
  const places = both.map((robot) => page.cellOf(robot));
  const steps = both.map((robot) => page.received.robot(robot).lowLevelSteps);
  await stays("stopped robots stand", 2, () =>
    both.every(
      (robot, i) =>
        page.cellOf(robot) === places[i] && page.received.robot(robot).lowLevelSteps === steps[i],
    ),
  );

  await page.press("Shift+G");
  await page.card("r1").getByText(texts.stopped).waitFor({ state: "hidden" });
  await until("somebody moves again", () =>
    both.some((robot, i) => page.cellOf(robot) !== places[i]),
  );
});

journey("a stop that does not arrive says so until it has", async (scene) => {
  const system = await scene.services({ robots: 2, planner: restless });
  const line = await scene.line(system.url);
  const page = await scene.open(line.url);
  await page.begin();
  line.hold();
  await page.press("Shift+Escape");
  await page.reads(texts.stopNotDelivered);
  line.release();
  await page.readsNoLonger(texts.stopNotDelivered);
  for (const robot of both) await page.card(robot).getByText(texts.stopped).waitFor();
});

journey("a second operator takes over with a reason that the first one reads", async (scene) => {
  const system = await scene.services({ robots: 2 });
  const ada = await scene.open(system.url, { name: "Ada" });
  await ada.begin();
  await ada.button(texts.iControl("r1")).waitFor();
  const ben = await scene.open(system.url, { name: "Ben" });
  await ben.button(texts.takesOver("Ada", "r1")).click();
  const dialog = ben.dialog(texts.takeOverDialog);
  const take = dialog.getByRole("button", { name: texts.takeOver });
  assert.equal(await take.isDisabled(), true, "not without a reason");
  await dialog.getByLabel(texts.reason).fill("Ada has a phone call");
  await take.click();
  await ben.button(texts.iControl("r1")).waitFor();
  await ada.button(texts.takesOver("Ben", "r1")).waitFor();
  assert.match(
    (await ada.card("r1").locator(".choose").getAttribute("title")) ?? "",
    /Ada has a phone call/,
  );

  // Ada can still stop Ben's robot.
  await ada
    .card("r1")
    .getByRole("button", { name: texts.stop("r1") })
    .click();
  await ben.card("r1").getByText(texts.stopped).waitFor();
  assert.equal(ben.received.control("r1").stoppedBy, ada.received.welcome.client);
  await ada.button(texts.log).click();
  await ada.panel(texts.commandLog).getByText("Ada has a phone call").waitFor();
});

journey("a person who gives a name asks for control, and gets it or not", async (scene) => {
  const system = await scene.services({ robots: 2 });
  const ada = await scene.open(system.url, { name: "" });
  await ada.page.getByLabel(texts.yourName).fill("Ada");
  await ada.begin();
  await ada.button(texts.iControl("r1")).waitFor();
  const ben = await scene.open(system.url, { name: "" });
  const ask = async (name) => {
    await ben.button(texts.takesOver("Ada", "r1")).click();
    const dialog = ben.dialog(texts.takeOverDialog);
    if (name) await dialog.getByLabel(texts.yourName).fill(name);
    await dialog.getByLabel(texts.reason).fill("lunch is over");
    await dialog.getByRole("button", { name: texts.askForControl }).click();
    await ben.button(texts.asked("Ada", "r1")).waitFor();
    await ada.reads(texts.asksFor("Ben", "r1"));
    await ada.reads("“lunch is over”");
  };
  await ask("Ben");
  await ada.button(texts.keep).click();
  await ben.reads(texts.keeps("Ada", "r1"));
  await ask();
  await ada.button(texts.handOver).click();
  await ben.reads(texts.gotControl("r1"));
  await ada.button(texts.takesOver("Ben", "r1")).waitFor();
  await ben.button(texts.iControl("r1")).waitFor();
  // The name is asked once.
  await ben.page.reload();
  await ben
    .button(texts.takesOver("Ada", "r2"))
    .or(ben.button(texts.iControl("r1")))
    .waitFor();
  assert.equal(
    ben.received.all("presence")[0].people.some(({ name }) => name === "Ben"),
    true,
  );
});

journey("robots are found in the list, and a group of them is stopped", async (scene) => {
  const system = await scene.services({ robots: 4, planner: restless });
  const page = await scene.open(system.url);
  await page.begin();
  await page.press("f");
  const fleet = page.panel(texts.fleet);
  const row = (robot) => fleet.getByLabel(texts.chooseRobot(robot));
  await fleet.getByLabel(texts.searchRobots).fill("r3");
  await until("only r3 is listed", async () => (await row("r1").count()) === 0);
  await row("r3").check();
  await fleet.getByLabel(texts.searchRobots).fill("");
  await row("r2").check();
  await fleet.getByLabel(texts.groupName).fill("north");
  await fleet.getByRole("button", { name: texts.saveGroup }).click();
  for (const robot of ["r2", "r3"]) await row(robot).uncheck();
  await fleet.getByRole("button", { name: texts.group("north", 2) }).click();
  await fleet.getByRole("button", { name: texts.stopTicked(2) }).click();
  for (const robot of ["r2", "r3"]) await page.card(robot).getByText(texts.stopped).waitFor();
  assert.deepEqual(
    ["r1", "r4"].map((robot) => page.received.control(robot)?.stopped ?? false),
    [false, false],
  );
});

const tokens = [
  { name: "Watcher", role: "observer", token: "observer-token" },
  { name: "Guide", role: "operator", token: "operator-token" },
];

journey("an observer sees everything and may only stop robots", async (scene) => {
  const system = await scene.services({
    robots: 1,
    planner: restless,
    tokens,
  });
  const guide = await scene.open(`${system.url}#token=operator-token`, { name: "Guide" });
  await guide.begin();
  const watcher = await scene.open(`${system.url}#token=observer-token`, { name: "Watcher" });
  assert.equal(new URL(watcher.page.url()).hash, "", "the token leaves the address");
  await watcher.moves("r1");
  await watcher.page.locator(".latency").getByText(texts.observer).waitFor();
  assert.equal(await watcher.button(texts.anyControl).count(), 0);
  assert.equal(await watcher.button(texts.resumeAll).isDisabled(), true);

  const { revision } = watcher.received.belief();
  assert.equal(await watcher.button(texts.anyTool).count(), 0, "no tools");
  await watcher.press("w");
  await watcher.pointAt({ row: 1, column: 1 });
  await watcher.page.mouse.down();
  await watcher.page.mouse.up();
  assert.deepEqual(watcher.received.asked, []);

  await watcher.button(texts.stopAll).click();
  await guide.card("r1").getByText(texts.stopped).waitFor();
  assert.equal(await watcher.button(texts.resume("r1")).isDisabled(), true);
  await watcher.press("g");
  const refused = await until("the service refuses to resume", () =>
    watcher.received.replies.find(({ accepted }) => !accepted),
  );
  assert.match(refused.reason, /observer/);
  assert.equal(guide.received.control("r1").stopped, true);
  assert.equal(guide.received.belief().revision, revision);
});

journey("with a wrong token the page shows nothing but the reason", async (scene) => {
  const system = await scene.services({ robots: 1, tokens });
  const page = await scene.openOnly(`${system.url}#token=wrong-token-0123456789`);
  await page.reads(/token/);
  assert.equal(await page.page.locator(".fleet-card").count(), 0);
  assert.deepEqual(page.received.all("robot"), []);
});
