import assert from "node:assert/strict";
import { writeBigMap } from "../support/big_map.mjs";
import { journey } from "../support/journey.mjs";
import { texts } from "../support/texts.mjs";
import { until } from "../support/wait.mjs";

const side = 1000;
/** In the open, far from the middle. */
const wanted = { row: 733, column: 147 };
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

  // On the whole map a cell is less than a pixel wide. The wheel zooms at the pointer, to the pixel.
  const { x, y } = await page.pointAt(wanted);
  const at = { x: Math.round(x), y: Math.round(y) };
  await mouse.move(at.x, at.y);
  for (let i = 0; i < 12; i += 1) await mouse.wheel(0, -200);
  const cellThere = async () => cellIn((await status.textContent()) ?? "");
  const leaves = (cell) => cell !== undefined && !isNear(cell, wanted);
  await mouse.move(at.x + 200, at.y);
  await until("another cell is there", async () => leaves(await cellThere()));
  await mouse.move(at.x, at.y);
  const comes = (cell) => cell !== undefined && isNear(cell, wanted) && cell;
  const spot = await until("the wheel keeps the place", async () => comes(await cellThere()));

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
  const box = await page.map.boundingBox();
  await mouse.click(box.x + 30, box.y + 30);
  await pointsAt({ row: 0, column: 0 });
});

journey("a robot crosses a waterway while a person edits its map", async (scene) => {
  const system = await scene.services({
    robots: 1,
    sim: { preset: "waterway", camera: { mode: "none" } },
    planner: { method: "greedy" },
  });
  const page = await scene.open(system.url, { name: "Ada" });
  await page.begin();
  await page.moves("r1");
  const { rows, columns } = page.received.newest("world", "w1");
  const water = page.received.belief().walls.findIndex((wall) => wall < 128);
  const cell = { row: Math.floor(water / columns), column: water % columns };
  assert.match(await page.wordsAbout(cell), texts.freeCell);
  await page.edits(cell);
  assert.equal(page.received.isWall(cell), true);
  await page.moves("r1");
  assert.deepEqual([rows, columns], [150, 150]);
});

/** The cell that a text names. */
function cellIn(text) {
  const [, row, column] = /Row (\d+), column (\d+):/.exec(text) ?? [];
  return row === undefined ? undefined : { row: Number(row), column: Number(column) };
}

function isNear(a, b) {
  return Math.abs(a.row - b.row) <= 2 && Math.abs(a.column - b.column) <= 2;
}

/** Indices of the cells that differ. */
function changed(before, after) {
  return [...after.keys()].filter((index) => before[index] !== after[index]);
}
