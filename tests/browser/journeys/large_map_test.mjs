import assert from "node:assert/strict";
import { writeBigMap } from "../support/big_map.mjs";
import { journey } from "../support/journey.mjs";
import { texts } from "../support/texts.mjs";

const side = 301;
/** In the open, far from the middle. */
const spot = { row: 233, column: 47 };

journey("a large map is zoomed, panned and edited at the cell that is meant", async (scene) => {
  const system = await scene.services({
    robots: 1,
    sim: {
      map: { yaml: writeBigMap(scene.folder, side, 100) },
      corruption: { wrong_share: 0 },
      camera: { mode: "none" },
    },
    planner: { method: "greedy" },
  });
  const page = await scene.open(system.url, { name: "Ada" });
  await page.begin();
  const { mouse } = page.page;
  const status = page.page.locator(".map-status span").first();
  const pointsAt = (cell) => status.filter({ hasText: texts.cell(cell) }).waitFor();

  // On the whole map a cell is 2 pixels wide. The wheel zooms at the pointer, which stays on its cell.
  const at = await page.pointAt(spot);
  for (let i = 0; i < 12; i += 1) await mouse.wheel(0, -200);
  await pointsAt(spot);

  // A drag moves the map with the pointer.
  await mouse.down();
  await mouse.move(at.x + 200, at.y + 90, { steps: 5 });
  await mouse.up();
  await pointsAt(spot);

  const before = page.received.belief();
  await page.tool(texts.wall).click();
  await mouse.click(at.x + 200, at.y + 90);
  const after = await page.waitsForRevision(before.revision + 1n);
  assert.deepEqual(changed(before.walls, after.walls), [spot.row * side + spot.column]);
  assert.match(await page.wordsAbout(spot), texts.wallCell);

  // The view follows the keyboard's cursor, and edits there.
  for (let i = 0; i < 12; i += 1) await page.press("+");
  await page.map.focus();
  for (const key of ["ArrowUp", "Control+Home", "ArrowDown", "ArrowRight"]) await page.press(key);
  await page.press(" ");
  const last = await page.waitsForRevision(before.revision + 2n);
  assert.deepEqual(changed(after.walls, last.walls), [side + 1]);
  await page.press("v");
  const { x, y } = await page.map.boundingBox();
  await mouse.click(x + 40, y + 40);
  await pointsAt({ row: 0, column: 0 });
});

/** Indices of the cells that differ. */
function changed(before, after) {
  return [...after.keys()].filter((index) => before[index] !== after[index]);
}
