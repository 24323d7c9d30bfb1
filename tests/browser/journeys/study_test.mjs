import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { once } from "node:events";
import { readFileSync, writeFileSync } from "node:fs";
import { createServer } from "node:net";
import { join } from "node:path";
import { makeCertificate } from "../support/certificate.mjs";
import { journey } from "../support/journey.mjs";
import { programs } from "../support/system.mjs";
import { texts } from "../support/texts.mjs";
import { until } from "../support/wait.mjs";

const protocol = `
name: journey
completion_code: random
eye_tracker: {tags: true}
maze: {speed: 20}
parts:
  - form: forms/consent.json
  - rest: 8
    id: baseline
    text: Please look at the middle.
  - maze: ig-mcts
    training: true
    layouts: [1001]
    title: Practice
    time_limit_s: 3
  - methods: [ig-mcts, instruction, teleop]
    layouts: [234, 666, 9]
    time_limit_s: 4
    introductions: {teleop: You drive it yourself.}
    after:
      - form: forms/nasa-tlx.json
  - form: forms/debriefing.json
`;

const scales = ["mental", "physical", "temporal", "performance", "effort", "frustration"];

/** Moves each slider of the questionnaire by a step. */
async function answersWorkload(page, already = 0) {
  const sliders = page.page.getByRole("slider");
  await until("the questionnaire", async () => (await sliders.count()) === scales.length);
  for (let i = already; i < scales.length; i++) {
    await sliders.nth(i).focus();
    await sliders.nth(i).press("ArrowRight");
  }
}

async function completes(page, name = texts.complete) {
  await page.button(name).click();
}

async function consents(page, complete) {
  await until("three boxes", async () => {
    const boxes = page.page.getByRole("checkbox");
    if ((await boxes.count()) !== 3) return false;
    for (const box of await boxes.all()) await box.check({ force: true }); // it is drawn by another element
    return true;
  });
  await completes(page, complete);
}

function resultOf(study, participant) {
  return until("the result is complete", () => {
    const json = JSON.parse(readFileSync(join(study.folder, participant, "result.json"), "utf8"));
    return json.complete ? json : undefined;
  });
}

async function freePort() {
  const server = createServer().listen(0, "127.0.0.1");
  await once(server, "listening");
  const { port } = server.address();
  server.close();
  await once(server, "close");
  return port;
}

/** Begins a maze, which then ends by its time limit. */
async function playsMaze(page, title) {
  await page.dialog(title).getByRole("button", { name: texts.begin }).click();
  await page.dialog(title).waitFor({ state: "hidden" });
}

journey(
  "a participant with an eye tracker goes from consent to debriefing, over the death of the operator service",
  async (scene) => {
    scene.expectConnectionTrouble(); // the service restarts between two steps
    const file = join(scene.folder, "journey.yaml");
    writeFileSync(file, protocol);
    const tracker = ["--eye-tracker", await scene.eyeTracker()];
    const study = await scene.liveStudy("--participant", "P01", "--protocol", file, ...tracker);
    const page = await scene.openOnly(study.url);

    await consents(page);

    await page.reads("Please look at the middle.");
    await page.button(texts.begin).click();
    await playsMaze(page, "Practice");

    for (const [number, method] of ["ig-mcts", "instruction", "teleop"].entries()) {
      const title = texts.part(number + 1, 3);
      if (method === "teleop")
        await page.dialog(title).getByText("You drive it yourself.").waitFor();
      await playsMaze(page, title);
      if (method !== "instruction") {
        await answersWorkload(page);
      } else {
        const sliders = page.page.getByRole("slider");
        await until("the questionnaire", async () => (await sliders.count()) === scales.length);
        await sliders.first().focus();
        await sliders.first().press("ArrowRight");
        await until("the draft is kept", () =>
          page.received.newest("draft")?.json.includes("mental"),
        );
        study.kill("P01/07-instruction-nasa-tlx/config/operator.yaml");
        await page.reads(texts.connectionLost);
        await page.readsNoLonger(texts.connectionLost);
        await answersWorkload(page, 1);
      }
      await completes(page);
    }

    await page.reads("Which way did you like best");
    await completes(page);
    const shown = await page.page.getByLabel("Completion code").inputValue();
    const result = await resultOf(study, "P01");
    assert.equal(result.completion_code, shown);
    const steps = new Map(result.steps.map((step) => [step.step, step]));
    assert.equal(steps.size, 10);
    assert.equal(steps.get("consent").answers.consent.length, 3);
    for (const method of ["ig-mcts", "instruction", "teleop"]) {
      assert.equal(steps.get(method).timed_out, true);
      assert.deepEqual(
        Object.keys(steps.get(`${method}-nasa-tlx`).answers).sort(),
        [...scales].sort(),
      );
    }
    const mazes = result.steps.filter(({ seed }) => seed !== undefined);
    assert.equal(new Set(mazes.map(({ seed }) => seed)).size, 4);

    const numbers = join(scene.folder, "report.json");
    execFileSync(join(programs, "conav-study-report"), [study.folder, "--json", numbers]);
    const { measures } = JSON.parse(readFileSync(numbers, "utf8"));
    for (const measure of ["mapping_accuracy", "low_level_steps", "tlx", "pcpd_mean"]) {
      for (const method of ["ig-mcts", "instruction", "teleop"]) {
        assert.equal(measures[measure].methods[method].trials, 1, `${measure} of ${method}`);
      }
    }
  },
);

const shortProtocol = `
name: elsewhere
language: de
words: forms/words-de.json
completion_code: random
maze: {camera: none}
parts:
  - form: forms/consent.json
    title: Einwilligung
  - maze: ig-mcts
    title: Labyrinth
    time_limit_s: 10
    text: Sehen Sie sich um.
  - form: forms/debriefing.json
    title: Ende
`;
/** Texts of that protocol, and names. */
const ownTexts = /^(Einwilligung|Labyrinth|Ende|Sehen Sie sich um\.|P02|r1)$/;

journey("a participant elsewhere comes with a link and goes with a code", async (scene) => {
  scene.expectConnectionTrouble(); // the service restarts between two steps
  const file = join(scene.folder, "elsewhere.yaml");
  writeFileSync(file, shortProtocol);
  const port = await freePort();
  const address = `https://localhost:${port}`;
  const { certificate, key } = makeCertificate(scene.folder);
  const study = await scene.liveStudy(
    ...["--participant", "P02", "--protocol", file, "--port", String(port)],
    ...["--public-url", address, "--tls-certificate", certificate, "--tls-key", key],
  );
  const opens = (url) => scene.openOnly(url, { name: "", ignoreHTTPSErrors: true });
  assert.ok(study.url.startsWith(`${address}/#token=`), study.url);

  const stranger = await opens(address);
  await stranger.reads(/token/);
  assert.deepEqual(stranger.received.all("task"), []);

  const page = await opens(study.url);
  const english = [];
  page.page.on("console", (message) => {
    const [, text] = /^no words for: (.*)$/s.exec(message.text()) ?? [];
    if (text !== undefined && !ownTexts.test(text.trim())) english.push(text);
  });
  await consents(page, "Abschließen");
  await page.dialog("Labyrinth").getByRole("button", { name: "Beginnen" }).click();
  assert.equal(await page.page.locator("a.skip").textContent(), "Zur Karte");
  assert.match(await page.page.title(), /Labyrinth$/);
  for (const tool of ["w", "p", "l"]) await page.press(tool);
  await page.reads("Auf der Karte zeigen");
  await page.press("Escape");
  await page.page.locator("canvas.map-surface").hover();
  await page.page
    .getByText(/^Zeile \d+, Spalte \d+: /)
    .first()
    .waitFor();
  await page.button(/Anleitung und Tasten/).click();
  await page.reads("Wände zeichnen");
  await page.reads("Which way did you like best");
  await completes(page, "Abschließen");
  const shown = await page.page.getByLabel("Code").inputValue();
  assert.deepEqual(english, [], "texts without a word");
  const result = await resultOf(study, "P02");
  assert.equal(result.completion_code, shown);
});
