import { describe, expect, it } from "vitest";
import { stateOf, type UpdateBody, welcomeMessage } from "../../state/fixtures";
import { reduce } from "../../state/reduce";
import { controlNews } from "./control_news";

const until = 100;
const held = (robot: string, holder: string, reason = ""): UpdateBody => ({
  case: "control",
  value: { robot, holder, holderName: holder === "me/1" ? "" : holder, reason, heldUntil: until },
});
const welcome = welcomeMessage({ client: "me/1" });
const mine = reduce(stateOf(held("r1", "me/1"), held("r2", "me/1")), welcome);

function afterwards(...bodies: UpdateBody[]) {
  return { ...mine, controls: stateOf(...bodies).controls };
}

describe("control that is lost", () => {
  it("to somebody is told with the reason, robots together", () => {
    const lost = afterwards(held("r1", "ben", "r1 is stuck"), held("r2", "ben", "r1 is stuck"));
    expect(controlNews(mine, lost, 50)).toEqual([
      "You control r1, r2 no more: ben took over (“r1 is stuck”).",
    ]);
  });

  it("because its time ran out is told, but not what was released by hand", () => {
    const lost = afterwards(held("r1", ""), held("r2", "me/1"));
    expect(controlNews(mine, lost, until)).toEqual([
      "You control r1 no more: nobody used this page for 60 s. “Take control” gives it back.",
    ]);
    expect(controlNews(mine, lost, until - 30)).toEqual([]);
  });

  it("is no news where nothing changed, somebody else had it, or another run began", () => {
    expect(controlNews(mine, mine, until)).toEqual([]);
    expect(controlNews(afterwards(held("r1", "ben")), afterwards(held("r1", "")), until)).toEqual(
      [],
    );
    const other = { ...afterwards(held("r1", "ben")), run: "another" };
    expect(controlNews(mine, other, until)).toEqual([]);
  });
});
