import { journey } from "../support/journey.mjs";
import { answersFirst } from "../support/newcomer.mjs";
import { texts } from "../support/texts.mjs";
import { until } from "../support/wait.mjs";

const robots = ["r1", "r2"];

journey("a person who follows the page's advice guides two robots to all goals", async (scene) => {
  const system = await scene.demo("--robots", "2", "--seed", "7");
  const page = await scene.open(system.url);
  await page.dialog(texts.ready2).waitFor();
  await page.begin();
  const states = () => robots.map((name) => page.received.robot(name));
  await until(
    "all goals are reached",
    async () => {
      await answersFirst(page);
      return states().every(({ goalsLeft }) => goalsLeft.length === 0);
    },
    { within: 200, every: 0.5, now: states },
  );
  const ending = page.panel(texts.ending);
  await ending.getByText(texts.allGoals(8)).waitFor();
  await ending.getByText(texts.replayHint).waitFor();
});
