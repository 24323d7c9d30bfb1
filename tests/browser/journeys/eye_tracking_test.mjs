import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { join } from "node:path";
import { journey } from "../support/journey.mjs";
import { programs } from "../support/system.mjs";
import { texts } from "../support/texts.mjs";
import { until } from "../support/wait.mjs";

/** Where AprilTag's own detector finds tags in a picture of the page. */
function tagsIn(picture) {
  const lines = execFileSync(join(programs, "find_tags"), [picture], { encoding: "utf8" });
  return lines
    .trim()
    .split("\n")
    .map((line) => line.split(" ").map(Number))
    .sort(([a], [b]) => a - b);
}

/** Runs in the page: controls and tags that share some of the page. */
function overlaps() {
  const boxes = (selector) =>
    [...document.querySelectorAll(selector)].map((element) => element.getBoundingClientRect());
  const tags = boxes(".page-tags svg");
  const shares = (a, b) =>
    a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
  return boxes("button, input, canvas, .panel").filter((box) =>
    tags.some((tag) => shares(tag, box)),
  ).length;
}

const near = (a, b, pixels) => Math.abs(a - b) <= pixels;

journey(
  "the participant's page has tags, and says where they, its panels and cells are",
  async (scene) => {
    const system = await scene.services({
      robots: 1,
      operator: {
        task: {
          kind: "mapping",
          participant: "P07",
          result: join(scene.folder, "r.json"),
          tags: true,
        },
      },
    });
    const page = await scene.openOnly(system.url);
    await page.dialog(texts.maze(1, 1)).getByRole("button", { name: texts.begin }).click();
    await page.map.waitFor();
    const { x, y } = await page.pointAt({ row: 3, column: 5 });
    const layout = await until("the page says where the map is", () => {
      const newest = page.received.layouts.at(-1);
      const isThere = newest?.world === "w1" && near(newest.mapX + 5 * newest.mapDx, x, 2);
      return isThere && newest.tags.length === 6 && newest;
    });
    assert.ok(near(layout.mapY + 3 * layout.mapDy, y, 2));
    assert.deepEqual(
      new Set(layout.areas.map(({ name }) => name)),
      new Set(["task", "map", "picture"]),
    );
    assert.equal(layout.width, 1400);

    const picture = join(scene.folder, "page.png");
    await page.page.screenshot({ path: picture });
    const found = tagsIn(picture);
    assert.deepEqual(
      found.map(([id]) => id),
      [0, 1, 2, 3, 4, 5],
    );
    for (const [id, ...corners] of found) {
      const tag = layout.tags.find(({ name }) => name === `tag${id}`);
      assert.ok(tag.width >= 96);
      const said = [tag.x, tag.y, tag.x + tag.width, tag.y + tag.height];
      said.forEach((at, i) => {
        assert.ok(near(at, corners[i], 1), `tag ${id}: ${said} but ${corners}`);
      });
    }
    assert.equal(await page.page.evaluate(overlaps), 0, "tags cover nothing");

    await page.page.setViewportSize({ width: 1200, height: 800 });
    await until("the new layout", () => page.received.layouts.at(-1).width === 1200);
  },
);
