import assert from "node:assert/strict";
import { journey } from "../support/journey.mjs";
import { texts } from "../support/texts.mjs";
import { until } from "../support/wait.mjs";

const near = { row: 6, column: 2 };
const behindWall = { row: 1, column: 10 };

journey("a person gives a robot of the field its goals on the map", async (scene) => {
  const system = await scene.services({
    robots: 1,
    field: true,
    planner: { method: "greedy" },
    operator: { goals: { robots: ["r1"] } },
  });
  const page = await scene.open(system.url, { name: "Ada" });
  await page.begin();
  await page.press("o");
  await page.reads(texts.goalCount(0, 0));

  // The robot takes it from /r1/goals, drives there, and its report makes it reached.
  await click(page, near);
  await has(page, "goalsReached", [near]);
  await page.reads(texts.goalCount(0, 1));
  // A goal counts as reached within 0.5 m of its centre, which may be short of its cell.
  const goalCell = `${near.row},${near.column}`;
  await until(`r1 in ${goalCell}`, () => page.cellOf("r1") === goalCell);

  await page.press("Shift+Escape");
  await page.card("r1").getByText(texts.stopped).waitFor();
  await click(page, behindWall);
  await has(page, "goalsLeft", [behindWall]);
  assert.match(await page.wordsAbout(behindWall), texts.goalHere("r1"));
  await click(page, behindWall); // the same again removes it
  await has(page, "goalsLeft", []);
  await page.press("Control+z");
  await has(page, "goalsLeft", [behindWall]);

  const other = await scene.open(system.url, { name: "Ben" });
  await other.press("o");
  await click(other, near);
  await other.reads(texts.notNow("Ada", "r1"));
  assert.deepEqual(other.received.requests("goals"), []);

  await page.button(texts.clearGoals).click();
  await has(page, "goalsLeft", []);
  await has(other, "goalsLeft", []);
});

async function click(page, cell) {
  const { x, y } = await page.pointAt(cell);
  await page.page.mouse.click(x, y);
}

/** Waits until the robot's goals of that kind, as its topic has them, are in these cells. */
function has(page, kind, cells) {
  const names = (all) => all.map(({ row, column }) => `${row},${column}`).join(" ");
  const now = () => names(page.received.robot("r1")[kind]);
  return until(`${kind} of r1: ${names(cells)}`, () => now() === names(cells), { now });
}
