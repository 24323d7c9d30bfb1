import { journey } from "../support/journey.mjs";
import { answersFirst } from "../support/newcomer.mjs";
import { until } from "../support/wait.mjs";

const robots = ["r1", "r2"];

journey(
  "somebody who does what the page asks for guides two robots to all goals",
  async (scene) => {
    const system = await scene.demo("--robots", "2", "--seed", "7");
    const page = await scene.open(system.url);
    await page.dialog("2 robots ready").waitFor();
    await page.begin();
    const told = () => robots.map((name) => page.told.robot(name));
    await until(
      "all goals are reached",
      async () => {
        await answersFirst(page);
        return told().every(({ goalsLeft }) => goalsLeft.length === 0);
      },
      { within: 200, every: 0.5, now: told },
    );
    const ending = page.panel("End of the run");
    await ending.getByText("All 8 goals reached").waitFor();
    await ending.getByText(/conav replay runs\/[\w-]+seed\d+ plays/).waitFor();
  },
);
