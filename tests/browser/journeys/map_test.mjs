import assert from "node:assert/strict";
import { journey } from "../support/journey.mjs";
import { texts } from "../support/texts.mjs";
import { until } from "../support/wait.mjs";

const cells = [
  { row: 11, column: 1 },
  { row: 11, column: 2 },
  { row: 11, column: 3 },
];

journey(
  "an edited wall is confirmed, seen by others, and can be undone and redone",
  async (scene) => {
    const system = await scene.services({ robots: 1 });
    const page = await scene.open(system.url, { name: "Ada" });
    const other = await scene.open(system.url, { name: "Ben" });
    await page.begin();
    const before = page.received.belief();
    for (const cell of cells) assert.match(await page.wordsAbout(cell), texts.freeCell);

    await page.draws(cells, texts.wall);
    const after = await other.waitsForRevision(before.revision + 1n);
    await page.waitsForRevision(before.revision + 1n);
    assert.equal(after.editedBy, page.received.welcome.client);
    for (const cell of cells) {
      assert.match(await page.wordsAbout(cell), texts.wallCell);
      assert.match(await other.wordsAbout(cell), texts.wallCell);
    }
    await page.readsNoLonger(texts.notConfirmed);

    await page.press("Control+z");
    await other.waitsForRevision(before.revision + 2n);
    assert.deepEqual(other.received.belief().walls, before.walls);
    await page.waitsForRevision(before.revision + 2n);
    await page.press("Control+y");
    await other.waitsForRevision(before.revision + 3n);
    assert.deepEqual(other.received.belief().walls, after.walls);
  },
);

journey("an edit on an old map is refused, stays visible, and can be sent again", async (scene) => {
  const system = await scene.services({ robots: 1 });
  const line = await scene.line(system.url);
  const late = await scene.open(line.url, { name: "Late" });
  const other = await scene.open(system.url, { name: "Other" });
  await other.dialog(texts.ready).getByRole("button", { name: texts.close }).click();
  await late.dialog(texts.ready).getByRole("button", { name: texts.close }).click();
  const { revision } = late.received.belief();
  const [mine, theirs] = cells;

  await late.beginsDrawing([mine], texts.wall); // a stale link would forbid to begin
  line.hold();
  await other.draws([theirs], texts.wall);
  await other.waitsForRevision(revision + 1n);
  await late.page.mouse.up();
  await late.reads(texts.oneCellSent);
  line.release();

  await late.page.getByRole("alert").getByText(texts.oneCellRefused).waitFor();
  const edit = late.received.requests("edit").at(-1);
  assert.equal(edit.body.value.baseRevision, revision);
  assert.match(late.received.replyTo(edit).reason, /revision/);
  assert.equal(other.received.belief().revision, revision + 1n, "nothing was changed");
  assert.equal(other.received.isWall(mine), false);

  await late.button(texts.sendAgain).click();
  await other.waitsForRevision(revision + 2n);
  assert.equal(other.received.isWall(mine), true);
  assert.equal(other.received.isWall(theirs), true);
  await late.page.getByText(texts.oneCellRefused).waitFor({ state: "hidden" });
});

journey("the chosen robot follows the path that is drawn for it", async (scene) => {
  // This method follows paths exactly; ig-mcts treats them as advice.
  const system = await scene.services({ robots: 2, planner: { method: "instruction" } });
  const page = await scene.open(system.url, { name: "Ada" });
  await page.dialog(texts.ready).getByRole("button", { name: texts.close }).click();
  await page.chooses("r1");
  const start = page.received.robot("r1").cell;
  const way = wayFrom(page, start);

  await page.drawsPath("r1", way);
  const guidance = await until("the service has the path", () => {
    const given = page.received.newest("guidance", "r1");
    return given?.givenBy === page.received.welcome.client ? given : undefined;
  });
  const names = (path) => path.map(({ row, column }) => `${row},${column}`);
  assert.deepEqual(names(guidance.path), names([start, ...way]));
  await page.reads(texts.pathBy);
  assert.notEqual(page.received.newest("guidance", "r2")?.givenBy, page.received.welcome.client);

  await page.press("g");
  for (const cell of way) {
    await until(`r1 comes by ${cell.row},${cell.column}`, () =>
      page.received
        .all("trail")
        .some((piece) => piece.robot === "r1" && names(piece.cells).includes(names([cell])[0])),
    );
  }
  assert.equal(page.received.robot("r2").cellMoves, 0n, "nobody resumed the other robot");
});

journey("only what the hand draws from a robot is sent", async (scene) => {
  const system = await scene.services({ robots: 2, planner: { method: "instruction" } });
  const page = await scene.open(system.url, { name: "Ada" });
  await page.dialog(texts.ready).getByRole("button", { name: texts.close }).click();
  await page.chooses("r1");
  const paths = () => page.received.requests("guide").length;
  const { cell, goalsLeft } = page.received.robot("r2");
  const [flag] = goalsLeft;

  // Beside the robot that is meant, while another one is chosen.
  await page.draws([{ row: cell.row, column: cell.column + 1 }, flag], texts.path);
  await page.reads(texts.startAtRobot);
  // On a flag.
  await page.draws([flag, cell], texts.path);
  assert.equal(paths(), 0, "nothing was sent for anybody");

  // Through a wall that a robot has seen.
  const { columns } = page.received.newest("world", "w1");
  const seen = page.received.newest("seen", "r2").cells;
  const isSeenWall = ({ row, column }) => seen[row * columns + column] === 2;
  const inLine = [1, 2, 3].flatMap((far) =>
    [
      [-far, 0],
      [far, 0],
      [0, -far],
      [0, far],
    ].map(([down, right]) => ({ row: cell.row + down, column: cell.column + right })),
  );
  const wall = inLine.find(isSeenWall);
  assert.ok(wall, "r2 sees a wall");
  await page.draws([cell, wall], texts.path);
  await page.reads(texts.sendAnyway);
  assert.equal(paths(), 0, "it waits for a second yes");
  await page.press("Enter");
  await until("the path is sent", () => paths() === 1);
  assert.equal(page.received.requests("guide")[0].body.value.robot, "r2");
});

/** Three cells in a row that are free on the operator's map and that the robot has seen free. */
function wayFrom(page, start) {
  const seen = page.received.newest("seen", "r1").cells;
  const { columns } = page.received.newest("world", "w1");
  const isOpen = (cell) =>
    !page.received.isWall(cell) && seen[cell.row * columns + cell.column] === 1;
  const isNew = (cell, way) =>
    way.every(({ row, column }) => row !== cell.row || column !== cell.column);
  const steps = ({ row, column }) =>
    [
      [-1, 0],
      [1, 0],
      [0, -1],
      [0, 1],
    ].map(([down, right]) => ({ row: row + down, column: column + right }));
  let ways = [[start]];
  for (let length = 0; length < 3; length += 1) {
    ways = ways.flatMap((way) =>
      steps(way.at(-1))
        .filter((cell) => isOpen(cell) && isNew(cell, way))
        .map((cell) => [...way, cell]),
    );
  }
  if (ways.length === 0) throw new Error("no way in sight of the robot");
  return ways[0].slice(1);
}
