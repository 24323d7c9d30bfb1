import assert from "node:assert/strict";
import { journey } from "../support/journey.mjs";
import { until } from "../support/wait.mjs";

const cells = [
  { row: 11, column: 1 },
  { row: 11, column: 2 },
  { row: 11, column: 3 },
];

journey(
  "an edited wall is confirmed, seen by others, and can be undone and done again",
  async (scene) => {
    const system = await scene.services({ robots: 1 });
    const page = await scene.open(system.url, { name: "Ada" });
    const other = await scene.open(system.url, { name: "Ben" });
    await page.begin();
    const before = page.told.belief();
    for (const cell of cells) assert.match(await page.wordsAbout(cell), /: free on your map/);

    await page.draws(cells, "Wall");
    const after = await other.waitsForRevision(before.revision + 1n);
    await page.waitsForRevision(before.revision + 1n);
    assert.equal(after.editedBy, page.told.welcome.client);
    for (const cell of cells) {
      assert.match(await page.wordsAbout(cell), /: wall on your map/);
      assert.match(await other.wordsAbout(cell), /: wall on your map/);
    }
    assert.equal(await page.page.getByText(/not confirmed yet/).count(), 0);

    await page.press("Control+z");
    await other.waitsForRevision(before.revision + 2n);
    assert.deepEqual(other.told.belief().walls, before.walls);
    await page.waitsForRevision(before.revision + 2n);
    await page.press("Control+y");
    await other.waitsForRevision(before.revision + 3n);
    assert.deepEqual(other.told.belief().walls, after.walls);
  },
);

journey("an edit on an old map is refused and shown, and can be sent again", async (scene) => {
  const system = await scene.services({ robots: 1 });
  const line = await scene.line(system.url);
  const late = await scene.open(line.url, { name: "Late" });
  const other = await scene.open(system.url, { name: "Other" });
  await other.dialog(/ready/).getByRole("button", { name: "Close" }).click();
  await late.dialog(/ready/).getByRole("button", { name: "Close" }).click();
  const { revision } = late.told.belief();
  const [mine, theirs] = cells;

  line.hold();
  await other.draws([theirs], "Wall");
  await other.waitsForRevision(revision + 1n);
  await late.draws([mine], "Wall");
  await late.reads("1 cell sent, not confirmed yet");
  line.release();

  await late.page.getByRole("alert").getByText("1 cell not saved:").waitFor();
  const edit = late.told.requests("edit").at(-1);
  assert.equal(edit.body.value.baseRevision, revision);
  assert.match(late.told.replyTo(edit).reason, /revision/);
  assert.equal(other.told.belief().revision, revision + 1n, "nothing was changed");
  assert.equal(other.told.isWall(mine), false);

  await late.button("Send again").click();
  await other.waitsForRevision(revision + 2n);
  assert.equal(other.told.isWall(mine), true);
  assert.equal(other.told.isWall(theirs), true);
  await late.page.getByText("1 cell not saved:").waitFor({ state: "hidden" });
});

journey("a path that is drawn for the chosen robot is the way that it takes", async (scene) => {
  // This method follows paths to the letter; ig-mcts takes them as advice.
  const system = await scene.services({ robots: 2, planner: { method: "instruction" } });
  const page = await scene.open(system.url, { name: "Ada" });
  await page.dialog(/ready/).getByRole("button", { name: "Close" }).click();
  await page.chooses("r1");
  const start = page.told.robot("r1").cell;
  const way = wayFrom(page, start);

  await page.draws([start, ...way], "Path");
  const guidance = await until("the service has the path", () => {
    const given = page.told.newest("guidance", "r1");
    return given?.givenBy === page.told.welcome.client ? given : undefined;
  });
  const texts = (path) => path.map(({ row, column }) => `${row},${column}`);
  assert.deepEqual(texts(guidance.path), texts([start, ...way]));
  await page.reads(/Path by/);
  assert.notEqual(page.told.newest("guidance", "r2")?.givenBy, page.told.welcome.client);

  await page.press("g");
  for (const cell of way) {
    await until(`r1 comes by ${cell.row},${cell.column}`, () =>
      page.told
        .all("trail")
        .some((piece) => piece.robot === "r1" && texts(piece.cells).includes(texts([cell])[0])),
    );
  }
  assert.equal(page.told.robot("r2").cellMoves, 0n, "nobody let the other one go");
});

/** Three cells, one after the other, free on the operator's map and, as far as the robot sees, in truth. */
function wayFrom(page, start) {
  const seen = page.told.newest("seen", "r1").cells;
  const { columns } = page.told.newest("world", "w1");
  const isOpen = (cell) => !page.told.isWall(cell) && seen[cell.row * columns + cell.column] === 1;
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
