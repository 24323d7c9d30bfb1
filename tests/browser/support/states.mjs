// States of the console for screenshots: each function sets up its state in a scene and calls `shoot(page, name, options)`.
import { writeBigMap } from "./big_map.mjs";
import { screen, teleoperation } from "./scene.mjs";
import { texts } from "./texts.mjs";
import { until } from "./wait.mjs";

const restless = { first_guidance_timeout_s: 0.2, answer_timeout_s: 2 };
const patient = {
  first_guidance_timeout_s: 0.2,
  answer_timeout_s: 600,
  timeout_clock: "simulation",
};

/** From the start dialog to a path that answers a picture, alerts, and a lost connection. */
export async function supervision(scene, shoot) {
  const system = await scene.services({ robots: 2, planner: patient });
  const page = await scene.open(system.url, { name: "Ada", colorScheme: "light" });
  await page.dialog(texts.ready).waitFor();
  await shoot(page, "start");
  await page.begin(texts.tour);
  await shoot(page, "tour");
  await page.button(texts.endTour).click();

  await until("both robots send pictures", () =>
    ["r1", "r2"].every((robot) => page.received.snapshots(robot).length > 0),
  );
  await page.press("n");
  await page.page.getByRole("img", { name: texts.anyPicture }).waitFor();
  await shoot(page, "supervising");

  await page.draws(
    [
      { row: 11, column: 1 },
      { row: 11, column: 2 },
      { row: 11, column: 3 },
    ],
    "Wall",
  );
  await page.draws([{ row: 1, column: 5 }], texts.wall);
  await page.button(texts.layers).click();
  await shoot(page, "editing");
  await page.press("Escape");

  const robot = page.received.snapshots("r1").length > 0 ? "r1" : "r2";
  await page.chooses(robot);
  await page.drawsPath(robot, [{ row: 1, column: 3 }]);
  await until("the path is given", () => page.received.newest("guidance", robot)?.path.length > 1);
  await shoot(page, "path");

  await page.press("w");
  await page.press("v");
  await page.button(texts.workload).click();
  await page.button(texts.log).click();
  await shoot(page, "workload-and-log");
  await page.press("?");
  await shoot(page, "help");
  await page.press("Escape");

  await page.press("Shift+Escape");
  await system.kill("planner");
  await page.panel(texts.alerts).locator("li").first().waitFor();
  await shoot(page, "alerts");
  scene.expectConnectionTrouble();
  await system.kill("operator");
  await page.link("lost");
  await shoot(page, "connection-lost");
}

/** The picture in README and docs/console.md: two robots, a picture, a path, and the queue. */
export async function readme(scene, shoot) {
  const system = await scene.services({ robots: 2, planner: patient });
  const page = await scene.open(system.url, { name: "Ada", colorScheme: "light" });
  await page.begin();
  await until("both robots send pictures", () =>
    ["r1", "r2"].every((robot) => page.received.snapshots(robot).length > 0),
  );
  await page.chooses("r1");
  await page.drawsPath("r1", [
    { row: 7, column: 10 },
    { row: 7, column: 7 },
  ]);
  await until("the path is given", () => page.received.newest("guidance", "r1")?.path.length > 1);
  await page.press("v");
  await page.press("n");
  await page.isChosen("r2");
  await page.page.getByRole("img", { name: texts.picture("r2") }).waitFor();
  await page.reads(texts.youAreOnIt);
  await page.page.mouse.move(0, 0);
  await page.page.evaluate(() => document.activeElement.blur());
  await shoot(page, "console");
}

/** Wide windows, cameras, the list of robots, the world in three dimensions, and a look back. */
export async function wideScreen(scene, shoot) {
  const system = await scene.services({ robots: 4, planner: restless });
  const wide = { width: 1920, height: 1080 };
  const page = await scene.open(system.url, { name: "Ada", colorScheme: "dark", viewport: wide });
  await page.begin();
  await until("pictures come", () => page.received.snapshots("r1").length > 1);
  await page.opensCamera("r1");
  await page.opensCamera("r3");
  await shoot(page, "wide-cameras");
  await page.button(texts.enlarge("r1")).click();
  await shoot(page, "wide-large-view");
  await page.press("Escape");
  await page.press("f");
  await shoot(page, "wide-fleet");
  await page.press("f");
  await page.press("3");
  await page.page.getByRole("img", { name: texts.solid }).waitFor();
  await page.moves("r1");
  await shoot(page, "wide-solid");
  await page.press("3");
  await page.looksBack(0.3);
  await shoot(page, "wide-past");
}

export async function bothThemes(scene, shoot) {
  const system = await scene.services({ robots: 2, planner: restless });
  const page = await scene.open(system.url, { name: "Ada", colorScheme: "dark" });
  await shoot(page, "dark-start");
  await page.begin();
  await until("pictures come", () => page.received.snapshots("r1").length > 1);
  await page.press("l");
  await page.page.getByLabel(texts.expectedEdits, { exact: true }).check();
  await page.page.getByLabel(texts.searchVisits, { exact: true }).check();
  await page.press("Escape");
  for (const theme of ["dark", "light"]) {
    await page.page.emulateMedia({ colorScheme: theme });
    await shoot(page, `${theme}-all-layers`);
  }
  const other = await scene.open(system.url, { name: "Ben", colorScheme: "dark" });
  await other.button(texts.anyTakeOver).click();
  await other.dialog(texts.takeOverDialog).waitFor();
  await shoot(other, "dark-take-over");
}

export async function manyRobots(scene, shoot) {
  const system = await scene.services({ robots: 16, planner: restless });
  const page = await scene.open(system.url, { name: "Ada", colorScheme: "dark" });
  await page.begin();
  await until("pictures come", () => page.received.all("snapshot").length > 4);
  await shoot(page, "16-robots");
  await page.press("Shift+Escape");
  await page.button(texts.resume("r16")).waitFor();
  await shoot(page, "16-robots-stopped");
}

export async function bigMap(scene, shoot) {
  const system = await scene.services({
    robots: 4,
    sim: { map: { yaml: writeBigMap(scene.folder) } },
    planner: { ...restless, method: "greedy" },
  });
  const page = await scene.open(system.url, { name: "Ada", colorScheme: "light" });
  await page.begin();
  await page.moves("r1");
  await shoot(page, "150x150");
  for (let i = 0; i < 6; i += 1) await page.press("+");
  await page.press("c");
  await shoot(page, "150x150-near");
}

export async function driving(scene, shoot) {
  const system = await scene.demo(...teleoperation);
  const page = await scene.open(system.url, { name: "Ada", colorScheme: "dark" });
  await page.begin();
  await page.reads(texts.driveHint);
  await until("frames come before anything moves", () => page.received.frames > 1);
  await shoot(page, "driving-at-rest");
  await page.page.keyboard.down("ArrowLeft");
  await until("the robot turns", () => page.received.robot("r1").lowLevelSteps > 3n);
  await shoot(page, "driving");
  await page.page.keyboard.up("ArrowLeft");
}

/** Both robots have reached all their goals. */
export async function ended(scene, shoot) {
  const system = await scene.demo("--seed", "7");
  const page = await scene.open(system.url, { name: "Ada", colorScheme: "light" });
  await page.begin(texts.watch);
  await page.panel(texts.ending).waitFor({ timeout: 120_000 });
  await shoot(page, "ended");
}

/** Method instruction: a live view, and paths. */
export async function streaming(scene, shoot) {
  const system = await scene.demo("--seed", "7", "--method", "instruction", "--operator", "silent");
  const page = await scene.open(system.url, { name: "Ada", colorScheme: "light" });
  await page.begin();
  await until("frames come", () => page.received.frames > 1);
  await page.tool(texts.path).click();
  await page.pointAt(page.received.robot("r1").cell);
  await page.page.mouse.down();
  await page.pointAt({ row: 9, column: 10 });
  await page.pointAt({ row: 10, column: 7 });
  await shoot(page, "drawing-a-path");
  await page.page.mouse.up();
}

export async function replaying(scene, shoot) {
  const system = await scene.replay("--seed", "7", "--robots", "2");
  const page = await scene.open(system.url, { name: "Ada", colorScheme: "light" });
  await page.press("l");
  await page.page.getByLabel(texts.trueMap, { exact: true }).check();
  await until("it has played for a while", () => page.received.newest("playback").position > 4);
  await shoot(page, "replay-layers");
  await page.press("Escape");
  await page.page.emulateMedia({ colorScheme: "dark" });
  await shoot(page, "replay");
}

export async function observing(scene, shoot) {
  const system = await scene.services({
    robots: 2,
    planner: restless,
    tokens: [
      { name: "Ben", role: "observer", token: "observer-token" },
      { name: "Ada", role: "operator", token: "operator-token" },
    ],
  });
  const ada = await scene.open(`${system.url}#token=operator-token`, { name: "Ada" });
  await ada.begin();
  await ada.moves("r1");
  const page = await scene.open(`${system.url}#token=observer-token`, { name: "Ben" });
  await page.reads(texts.hasControl("Ada"));
  await shoot(page, "observer");
}

export async function smallScreen(scene, shoot) {
  const system = await scene.services({ robots: 2, planner: restless });
  for (const [name, width, height] of [
    ["laptop", 1280, 720],
    ["tablet", 820, 1100],
    ["phone", 390, 800],
  ]) {
    const page = await scene.open(system.url, {
      name: "Ada",
      viewport: { ...screen, width, height },
    });
    await page
      .dialog(texts.ready)
      .getByRole("button", { name: texts.close })
      .click({ timeout: 2000 })
      .catch(() => undefined);
    await shoot(page, name);
    if (name === "phone") await shoot(page, "phone-whole", { fullPage: true });
  }
}
