/**
 * Acts like a person who knows only what the console shows: goes to the first robot in the queue and draws a path to its nearest
 * flag, around the walls on the map.
 * @param {import("./console_page.mjs").ConsolePage} page
 * @returns {Promise<boolean>} whether there was something to do
 */
export async function answersFirst(page) {
  const items = page.received.newest("attention")?.items ?? [];
  const first = items.find(({ robot }) => page.received.robot(robot).goalsLeft.length > 0);
  if (first === undefined) return false;
  const { robot } = first;
  await page.chooses(robot);
  const { cell, goalsLeft } = page.received.robot(robot);
  const way = shortestWay(cell, goalsLeft, (next) => showsWall(page, next));
  if (way === undefined) throw new Error(`the map shows no route for ${robot}`);
  await page.drawsPath(robot, cornersOf(way).slice(1));
  return true;
}

const same = (a, b) => a.row === b.row && a.column === b.column;

/** What robots saw overrides the map. */
function showsWall(page, cell) {
  const { rows, columns } = page.received.newest("world", "w1");
  const { row, column } = cell;
  if (row <= 0 || column <= 0 || row >= rows - 1 || column >= columns - 1) return true;
  const seen = page.received.all("seen").map(({ cells }) => cells[row * columns + column]);
  return seen.includes(2) || (!seen.includes(1) && page.received.isWall(cell));
}

/** Cells from `start` to the nearest of `goals`, both included. */
function shortestWay(start, goals, isWall) {
  const ways = [[start]];
  const known = new Set([`${start.row} ${start.column}`]);
  for (const way of ways) {
    const { row, column } = way.at(-1);
    if (goals.some((goal) => same(goal, { row, column }))) return way;
    for (const [down, right] of [
      [1, 0],
      [-1, 0],
      [0, 1],
      [0, -1],
    ]) {
      const next = { row: row + down, column: column + right };
      const name = `${next.row} ${next.column}`;
      if (known.has(name) || isWall(next)) continue;
      known.add(name);
      ways.push([...way, next]);
    }
  }
  return undefined;
}

/** The ends and turns of the route, since people do not stop in each cell. */
function cornersOf(way) {
  return way.filter((_, i) => {
    const [before, after] = [way[i - 1], way[i + 1]];
    if (before === undefined || after === undefined) return true;
    return before.row !== after.row && before.column !== after.column;
  });
}
