import assert from "node:assert/strict";
import { journey } from "../support/journey.mjs";
import { numberOf } from "../support/protocol.mjs";
import { texts } from "../support/texts.mjs";
import { until } from "../support/wait.mjs";

const picture = numberOf("AttentionReason", "REASON_SNAPSHOT");
const nothingNew = numberOf("SnapshotAnswer", "ANSWER_NOTHING_NEW");

journey("a newcomer guides the robots from the start dialog", async (scene) => {
  const system = await scene.demo("--robots", "2", "--seed", "7", "--mapping-value", "4");
  const page = await scene.open(system.url);

  await page.dialog(texts.ready2).waitFor();
  assert.equal(page.received.control("r1").stopped, true);
  await page.begin();
  await page.button(texts.iControl("r1")).waitFor();
  await page.moves("r1");

  const asks = () =>
    page.received.newest("attention")?.items.find(({ reason }) => reason === picture);
  const { robot } = await until("a robot sends a picture", asks);
  await page.chooses(robot);
  const image = page.page.getByRole("img", { name: texts.picture(robot) });
  await image.waitFor();
  assert.equal(await image.evaluate((img) => img.naturalWidth), 320);

  const { sequenceNumber } = page.received.snapshots(robot).at(-1);
  await page.button(texts.nothingNew).click();
  await page.reads(texts.answeredNothingNew);
  await until("the service has the answer", () => {
    const picture = page.received
      .snapshots(robot)
      .find((one) => one.sequenceNumber === sequenceNumber);
    return picture.answer === nothingNew && picture.answeredBy === page.received.welcome.client;
  });

  // Neither the one that was just answered nor one that the robot is about to give up.
  await until("another picture", () => {
    const { stamp, items } = page.received.newest("attention");
    const isOver = (item) => item.robot === robot && item.newestSnapshot <= sequenceNumber;
    const isFirm = ({ deadline }) => deadline === 0 || deadline > stamp + 4;
    const isPicture = ({ reason }) => reason === picture;
    return items.some(isPicture) && items.every((item) => !isOver(item) && isFirm(item));
  });
  await page.press("n");
  const mine = await until(
    "N selects the next item",
    () =>
      page.received
        .newest("attention")
        .items.find(({ selectedBy }) => selectedBy === page.received.welcome.client),
    {
      now: () => [
        page.received.newest("attention").items,
        page.received.requests("select"),
        page.received.replies,
      ],
    },
  );
  await page.isChosen(mine.robot);
});
