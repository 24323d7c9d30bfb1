import assert from "node:assert/strict";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { finds } from "../support/axe.mjs";
import { journey } from "../support/journey.mjs";
import { texts } from "../support/texts.mjs";
import { until } from "../support/wait.mjs";

const consent = {
  version: "1",
  title: "Consent",
  pages: [
    {
      elements: [
        { type: "html", name: "text", html: "<p>You may stop at any time.</p>" },
        { type: "boolean", name: "agrees", title: "I agree", isRequired: true },
      ],
    },
    {
      elements: [
        { type: "text", name: "age", title: "Your age", inputType: "number", isRequired: true },
        { type: "rating", name: "mood", title: "Your mood", rateMax: 7 },
        { type: "radiogroup", name: "hand", title: "You write", choices: ["left", "right"] },
        {
          type: "matrix",
          name: "trust",
          title: "The robot",
          columns: [1, 2, 3],
          rows: ["careful"],
        },
        { type: "dropdown", name: "land", title: "Where you live", choices: ["here", "there"] },
        { type: "comment", name: "more", title: "What else" },
        { type: "text", name: "check", title: "Write yes", attention: "yes" },
      ],
    },
  ],
};

const thanks = { type: "html", name: "thanks", html: "<p>Thank you for your time.</p>" };

/** Configurations of the steps of one participant, and where their results are. */
function protocolIn(folder) {
  writeFileSync(join(folder, "consent.json"), JSON.stringify(consent));
  writeFileSync(join(folder, "end.json"), JSON.stringify({ elements: [thanks] }));
  const result = (step) => join(folder, `${step}.json-result`);
  const common = { participant: "P07", count: 3, experimenter: true };
  const task = (number, step, title, more) => ({
    ...{ ...common, number, step, title, result: result(step) },
    ...more,
  });
  const form = (name) => ({ kind: "form", form: join(folder, `${name}.json`) });
  return {
    resultOf: (step) => JSON.parse(readFileSync(result(step), "utf8")),
    isOver: (step) => existsSync(result(step)),
    consent: task(1, "consent", "Consent", form("consent")),
    rest: task(2, "rest", "A short rest", { kind: "rest", rest_s: 5 }),
    end: task(3, "end", "The end", { ...form("end"), completion_code: "C-77" }),
  };
}

journey(
  "a participant goes through forms and a rest while an experimenter leads",
  async (scene) => {
    scene.expectConnectionTrouble(); // the service restarts between two steps, and is killed
    const protocol = protocolIn(scene.folder);
    const system = await scene.services({ robots: 0, operator: { task: protocol.consent } });
    const person = await scene.openOnly(system.url, { colorScheme: "dark" });
    const lead = await scene.openOnly(`${system.url}/?experimenter`, { colorScheme: "dark" });
    await lead.reads(texts.pageConnected);

    // A form, whose answers outlive service and page.
    await person.reads(texts.step(1, 3));
    await person.reads("You may stop at any time.");
    await finds(person, "first page of a form");
    await person.page.getByText("Yes", { exact: true }).click();
    await person.button("Next").click();
    await person.page.getByLabel("Your age").fill("41");
    await person.page.getByLabel("What else").fill("nothing");
    await finds(person, "second page of a form");
    await until("the experimenter sees it", async () => {
      const field = lead.page.getByLabel("What else");
      return (await field.count()) > 0 && (await field.inputValue()) === "nothing";
    });
    await finds(lead, "experimenter, form");
    await system.kill("operator");
    await system.startAgain("operator");
    await person.page.reload();
    assert.equal(await person.page.getByLabel("Your age").inputValue(), "41", "nothing is lost");
    await person.page.getByLabel("Write yes").fill("yes");

    // A pause covers the page.
    await lead.button(texts.pause).click();
    await person.dialog(texts.paused).waitFor();
    await person.press("Escape");
    await person.press("Escape");
    await person.dialog(texts.paused).waitFor();
    await finds(person, "paused");
    await lead.page.getByLabel(texts.newNote).fill("asked about the robot");
    await lead.button(texts.saveNote).click();
    await lead.panel(texts.notes).getByText("asked about the robot").waitFor();
    await lead.button(texts.continue).click();
    await person.dialog(texts.paused).waitFor({ state: "hidden" });
    await person.button(texts.complete).click();
    await person.reads(texts.preparing);
    const { answers, attention_passed, pauses, log } = protocol.resultOf("consent");
    assert.deepEqual(answers, { agrees: true, age: 41, more: "nothing", check: "yes" });
    assert.equal(attention_passed, true);
    assert.equal(pauses, 1);
    assert.ok(log.some(({ text }) => text === "asked about the robot"));

    // A rest begins when the person is ready, stands while it is paused, and ends by itself.
    await system.startTask(protocol.rest);
    await person.reads(texts.step(2, 3));
    await finds(person, "before a rest");
    await person.button(texts.begin).click();
    await person.page.getByRole("img", { name: texts.lookAtCross }).waitFor();
    await lead.button(texts.pause).click();
    await person.dialog(texts.paused).waitFor();
    await new Promise((resolve) => setTimeout(resolve, 6000));
    assert.equal(protocol.isOver("rest"), false, "the time does not count");
    await lead.button(texts.continue).click();
    await finds(person, "rest");
    await until("the rest ends", () => protocol.isOver("rest"));
    const rest = protocol.resultOf("rest");
    assert.ok(rest.duration_s >= 5 && rest.duration_s < 8, `${rest.duration_s} s`);
    assert.ok(rest.paused_s >= 6);

    // The last form gives the code.
    await system.startTask(protocol.end);
    await person.reads(texts.step(3, 3));
    await person.button(texts.complete).click();
    const code = person.page.getByLabel(texts.completionCode);
    assert.equal(await code.inputValue(), "C-77");
    await finds(person, "completion code");
    assert.equal(
      person.received.newest("studyLog"),
      undefined,
      "notes are not for the participant",
    );
    await lead.reads("finished");
  },
);

journey("an experimenter aborts a step, with a reason", async (scene) => {
  const protocol = protocolIn(scene.folder);
  const system = await scene.services({ robots: 0, operator: { task: protocol.consent } });
  const lead = await scene.openOnly(`${system.url}/?experimenter`);
  await lead.reads(texts.pageNotConnected);
  await lead.button(texts.abort).click();
  await lead.page.getByLabel(texts.reason).fill("nobody came");
  await lead.button(texts.abortForGood).click();
  await lead.reads("aborted");
  const { aborted, reason } = protocol.resultOf("consent");
  assert.deepEqual({ aborted, reason }, { aborted: true, reason: "nobody came" });
});

journey("a pause stops the robot of a maze, which goes on after it", async (scene) => {
  const result = join(scene.folder, "maze.json");
  const task = { kind: "study", participant: "P07", step: "maze", title: "First part", result };
  const more = { introduction: "Lead the robot.\n\nTake your time.", experimenter: true };
  const system = await scene.services({ robots: 1, operator: { task: { ...task, ...more } } });
  const person = await scene.openOnly(system.url, { colorScheme: "dark" });
  const lead = await scene.openOnly(`${system.url}/?experimenter`, { colorScheme: "dark" });
  await person.dialog("First part").getByText("Take your time.").waitFor();
  await person.dialog("First part").getByRole("button", { name: texts.begin }).click();
  await person.moves("r1");
  await lead.map.waitFor();
  await finds(lead, "experimenter, maze");
  await lead.button(texts.pause).click();
  await person.dialog(texts.paused).waitFor();
  await until("the robot stops", () => person.received.robot("r1").stopped);
  await lead.button(texts.continue).click();
  await until("the robot may drive", () => !person.received.robot("r1").stopped);
});
