import assert from "node:assert/strict";
import { journey } from "../support/journey.mjs";
import { numberOf } from "../support/protocol.mjs";
import { texts } from "../support/texts.mjs";
import { until } from "../support/wait.mjs";

const picture = numberOf("AttentionReason", "REASON_SNAPSHOT");
const nothingNew = numberOf("SnapshotAnswer", "ANSWER_NOTHING_NEW");
/** Robots start at once, soon send pictures, and then wait for answers as long as it takes. */
const patient = {
  search: { mapping_value: 4 },
  first_guidance_timeout_s: 0.2,
  answer_timeout_s: 600,
  timeout_clock: "simulation",
};
const corner = { row: 1, column: 1 };
const farthest = 60; // elements that Tab may pass

journey("everything can be done by the keyboard alone", async (scene) => {
  const system = await scene.services({ robots: 2, planner: patient });
  const page = await scene.open(system.url, { name: "Ada" });
  const press = async (...keys) => {
    for (const key of keys) await page.press(key);
  };

  // Start: the dialog focuses its main choice.
  await page.dialog(texts.ready2).waitFor();
  await press("Enter");
  await page.button(texts.iControl("r1")).waitFor();

  await press("j");
  await page.isChosen("r2");
  await press("k");
  await page.isChosen("r1");

  // Edit: Tab leads to the map, the arrow keys to the cell.
  await tabsTo(page, page.map);
  const { revision } = page.received.belief();
  await press("w", "ArrowUp", "Control+Home", "ArrowDown", "ArrowRight");
  await spoken(page, `${texts.cell(corner)} free`);
  await press(" ");
  await page.waitsForRevision(revision + 1n);
  await spoken(page, `${texts.cell(corner)} wall`);
  await press("Control+z");
  await page.waitsForRevision(revision + 2n);
  assert.equal(page.received.isWall(corner), false);

  // Draw a path to the cursor and send it.
  const me = page.received.welcome.client;
  await press("p", " ");
  await page.reads(texts.pathNotSent);
  await press("Enter");
  const given = await until("the service has the path", () => {
    const guidance = page.received.newest("guidance", "r1");
    return guidance?.givenBy === me ? guidance : undefined;
  });
  const { row, column } = given.path.at(-1);
  assert.deepEqual([row, column], [1, 1]);
  await press("Escape", "v");

  // The skip link focuses the map, and so does N if nothing has the focus.
  const skip = page.page.getByRole("link", { name: texts.skipToMap });
  await skip.focus();
  await press("Enter");
  assert.ok(await hasFocus(page.map));
  await page.map.evaluate((canvas) => canvas.blur());
  await press("n");
  assert.ok(await hasFocus(page.map));
  await press("Escape");

  // Answer a picture.
  await until("a robot asks about a picture", () =>
    page.received.newest("attention").items.some(({ reason }) => reason === picture),
  );
  const { robot } = await until("N goes to it", async () => {
    const before = page.received.requests("select").length;
    await press("n");
    const selected = await until("the service has the selection", () => {
      const selection = page.received.requests("select").at(before);
      return selection && page.received.replyTo(selection) && selection.body.value;
    });
    return selected.reason === picture && selected;
  });
  await page.page.getByRole("heading", { name: `${robot}: picture` }).waitFor();
  const answer = page.button(texts.nothingNew);
  await until("it may be answered", () => answer.isEnabled());
  await press("x");
  await until("the service has the answer", () =>
    page.received
      .all("snapshot")
      .some(({ answer, answeredBy }) => answer === nothingNew && answeredBy === me),
  );
  await page.reads(texts.answeredByYou);

  await press("Shift+Escape");
  for (const robot of ["r1", "r2"]) await page.card(robot).getByText(texts.stopped).waitFor();

  await press("?");
  const help = page.dialog(texts.help);
  await help.getByText(texts.helpStopAll).waitFor();
  await press("Escape");
  await help.waitFor({ state: "hidden" });
});

/** Presses Tab until `target` has the focus. The focus must be visible on the way. */
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

/** Waits for the text that a screen reader reads about the cell under the cursor. */
function spoken(page, text) {
  return page.page
    .locator(".map-status output")
    .filter({ hasText: text })
    .waitFor({ state: "attached" });
}
