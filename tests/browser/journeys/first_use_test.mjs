import assert from "node:assert/strict";
import { journey } from "../support/journey.mjs";
import { numberOf } from "../support/protocol.mjs";
import { until } from "../support/wait.mjs";

const picture = numberOf("AttentionReason", "REASON_PICTURE");
const nothingNew = numberOf("PictureAnswer", "ANSWER_NOTHING_NEW");

journey("a newcomer guides the robots from the start dialog on", async (scene) => {
  const system = await scene.demo("--robots", "2", "--seed", "7");
  const page = await scene.open(system.url);

  await page.dialog("2 robots ready").waitFor();
  assert.equal(page.told.control("r1").stopped, true);
  await page.begin();
  await page.button(/You control r1/).waitFor();
  await page.moves("r1");

  const asks = () => page.told.newest("attention")?.items.find(({ reason }) => reason === picture);
  const { robot } = await until("a robot sends a picture", asks);
  await page.chooses(robot);
  const image = page.page.getByRole("img", { name: new RegExp(`Picture \\d+ of ${robot}`) });
  await image.waitFor();
  assert.equal(await image.evaluate((img) => img.naturalWidth), 320);

  const { sequenceNumber } = page.told.pictures(robot).at(-1);
  await page.button(/Nothing new here/).click();
  await page.reads(/nothing new/i);
  await until("the service has the answer", () => {
    const picture = page.told.pictures(robot).find((one) => one.sequenceNumber === sequenceNumber);
    return picture.answer === nothingNew && picture.answeredBy === page.told.welcome.client;
  });

  // Not the one that was just answered, and none that the robot is about to give up.
  await until("another question", () => {
    const { stamp, items } = page.told.newest("attention");
    const isOver = (item) => item.robot === robot && item.newestSnapshot <= sequenceNumber;
    const isFirm = ({ deadline }) => deadline === 0 || deadline > stamp + 4;
    return items.length > 0 && items.every((item) => !isOver(item) && isFirm(item));
  });
  await page.press("n");
  const mine = await until(
    "N turns to what asks next",
    () =>
      page.told
        .newest("attention")
        .items.find(({ selectedBy }) => selectedBy === page.told.welcome.client),
    {
      now: () => [
        page.told.newest("attention").items,
        page.told.requests("select"),
        page.told.replies,
      ],
    },
  );
  await page.isChosen(mine.robot);
});
