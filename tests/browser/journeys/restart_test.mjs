import assert from "node:assert/strict";
import { journey } from "../support/journey.mjs";
import { texts } from "../support/texts.mjs";
import { until } from "../support/wait.mjs";

const first = { row: 1, column: 1 };
const second = { row: 1, column: 3 };

journey(
  "a killed operator service comes back with all edits, and executes a waiting edit once",
  async (scene) => {
    const system = await scene.services({ robots: 1, planner: { first_guidance_timeout_s: 0.2 } });
    scene.expectConnectionTrouble();
    const page = await scene.open(system.url);
    await page.begin();
    await page.toggles(first);
    const accepted = page.received.belief();
    const [wasFirst, isWall] = [first, second].map((cell) => page.received.isWall(cell));

    // The service does not receive this edit before it dies.
    await page.beginsDrawing([second], isWall ? texts.erase : texts.wall);
    system.signal("operator", "SIGSTOP");
    await page.page.mouse.up();
    await page.reads(texts.oneCellSent);
    const edit = page.received.requests("edit").at(-1);
    await system.kill("operator");
    await page.link("lost");
    await page.reads(texts.connectionLost);
    const alive = page.page.locator(".fleet-card .good, .services .good");
    assert.equal(await alive.count(), 0, "nothing looks live under the banner");
    await system.startAgain("operator");
    await page.link("live");

    await until("the service answers the repeated edit", () => page.received.replyTo(edit));
    const repeats = page.received.requests("edit").filter(({ id }) => id === edit.id);
    assert.equal(repeats.length, 2, "sent once before and once after");
    assert.equal(page.received.replyTo(edit).reason, "");
    await until("the edit is on the map", () => page.received.isWall(second) !== isWall);
    const belief = page.received.belief();
    assert.equal(belief.revision, accepted.revision + 1n, "done once");
    assert.equal(page.received.isWall(first), wasFirst, "the edit of before is there");
    await page.moves("r1");
  },
);

journey(
  "an edit that was executed but not answered before the service died is not executed twice",
  async (scene) => {
    const system = await scene.services({ robots: 1 });
    scene.expectConnectionTrouble();
    const line = await scene.line(system.url);
    const page = await scene.open(line.url);
    const witness = await scene.open(system.url);
    await page.begin();
    const before = page.received.belief();
    const isWall = page.received.isWall(first);

    await page.beginsDrawing([first], isWall ? texts.erase : texts.wall);
    line.hold();
    await page.page.mouse.up();
    await until(
      "the edit is done",
      () => witness.received.belief().revision === before.revision + 1n,
    );
    assert.equal(page.received.belief().revision, before.revision);
    await system.kill("operator");
    line.cut();
    await page.link("lost");
    await system.startAgain("operator");
    line.release();
    line.mend();
    await page.link("live");

    const edit = page.received.requests("edit").at(-1);
    const reply = await until("the service answers the repeated edit", () =>
      page.received.replyTo(edit),
    );
    assert.deepEqual([reply.accepted, reply.reason], [true, ""]);
    await until("the page has the map again", () => page.received.isWall(first) !== isWall);
    assert.equal(page.received.belief().revision, before.revision + 1n);
    await page.readsNoLonger(texts.notConfirmed);
  },
);
