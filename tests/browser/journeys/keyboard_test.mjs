import assert from "node:assert/strict";
import { journey } from "../support/journey.mjs";
import { numberOf } from "../support/protocol.mjs";
import { until } from "../support/wait.mjs";

const picture = numberOf("AttentionReason", "REASON_PICTURE");
const nothingNew = numberOf("PictureAnswer", "ANSWER_NOTHING_NEW");
/** Robots go at once, and then wait for answers as long as it takes. */
const patient = {
  first_guidance_timeout_s: 0.2,
  answer_timeout_s: 600,
  timeout_clock: "simulation",
};
const farthest = 60; // elements that Tab may pass

journey("everything can be done by the keyboard alone", async (scene) => {
  const system = await scene.services({ robots: 2, planner: patient });
  const page = await scene.open(system.url, { name: "Ada" });
  const press = async (...keys) => {
    for (const key of keys) await page.press(key);
  };

  // Begins: the dialog has the focus on what is done most.
  await page.dialog("2 robots ready").waitFor();
  await press("Enter");
  await page.button(/You control r1/).waitFor();

  await press("j");
  await page.isChosen("r2");
  await press("k");
  await page.isChosen("r1");

  // Edits: the map is reached by Tab, the cell by the arrow keys.
  await tabsTo(page, page.map);
  const { revision } = page.told.belief();
  await press("w", "ArrowUp", "Control+Home", "ArrowDown", "ArrowRight");
  await spoken(page, "Row 1, column 1: free on your map");
  await press(" ");
  await page.waitsForRevision(revision + 1n);
  await spoken(page, "Row 1, column 1: wall on your map");
  await press("Control+z");
  await page.waitsForRevision(revision + 2n);
  assert.equal(page.told.isWall({ row: 1, column: 1 }), false);

  // Draws a path to where the cursor is, and sends it.
  const me = page.told.welcome.client;
  await press("p", " ");
  await page.reads("Not sent yet");
  await press("Enter");
  const given = await until("the service has the path", () => {
    const guidance = page.told.newest("guidance", "r1");
    return guidance?.givenBy === me ? guidance : undefined;
  });
  const { row, column } = given.path.at(-1);
  assert.deepEqual([row, column], [1, 1]);
  await press("Escape", "v");

  // "To the map" leads to the map itself; N, too, where nothing has the focus.
  const skip = page.page.getByRole("link", { name: "To the map" });
  await skip.focus();
  await press("Enter");
  assert.ok(await hasFocus(page.map));
  await page.map.evaluate((canvas) => canvas.blur());
  await press("n");
  assert.ok(await hasFocus(page.map));
  await press("Escape");

  // Answers a picture.
  const asks = () => page.told.newest("attention").items.filter(({ reason }) => reason === picture);
  await until("a robot asks about a picture", () => asks().length > 0);
  await until(
    "N goes to it",
    async () => {
      await press("n");
      return asks().some(({ selectedBy }) => selectedBy === me);
    },
    { every: 0.5 },
  );
  await press("x");
  await until("the service has the answer", () =>
    page.told
      .all("picture")
      .some(({ answer, answeredBy }) => answer === nothingNew && answeredBy === me),
  );
  await page.reads(/nothing new, by you/);

  await press("Shift+Escape");
  for (const robot of ["r1", "r2"]) await page.card(robot).getByText("■ stopped").waitFor();

  await press("?");
  const help = page.dialog("Keys and signs");
  await help.getByText("Stop all robots").waitFor();
  await press("Escape");
  await help.waitFor({ state: "hidden" });
});

/** Tab, until the focus is there; it can be seen wherever it is. */
async function tabsTo(page, target) {
  for (let i = 0; i < farthest; i += 1) {
    await page.press("Tab");
    const outlined = await page.page.evaluate(() => {
      const { outlineStyle, outlineWidth, boxShadow } = getComputedStyle(document.activeElement);
      return (
        (outlineStyle !== "none" && Number.parseFloat(outlineWidth) > 0) || boxShadow !== "none"
      );
    });
    assert.ok(outlined, `the focus can be seen at ${await focusText(page)}`);
    if (await hasFocus(target)) return;
  }
  throw new Error(`not within ${farthest} times Tab; the focus is at ${await focusText(page)}`);
}

function hasFocus(target) {
  return target.evaluate((element) => element === document.activeElement);
}

function focusText(page) {
  return page.page.evaluate(() => document.activeElement?.outerHTML.slice(0, 200));
}

/** What a screen reader reads of the cell under the cursor. */
function spoken(page, text) {
  return page.page
    .locator(".map-status output")
    .filter({ hasText: text })
    .waitFor({ state: "attached" });
}
