import { describe, expect, it } from "vitest";
import { emptyState } from "../../state/console_state";
import { stateOf, type UpdateBody } from "../../state/fixtures";
import { Tour } from "./tour";
import type { TourState } from "./tour_steps";

const tourState = (selections: number, ...bodies: UpdateBody[]): TourState => ({
  state: bodies.length > 0 ? stateOf(...bodies) : emptyState,
  chosenRobot: "r1",
  selections,
});
const path = (givenBy: string, revision: bigint): UpdateBody => ({
  case: "guidance",
  value: { robot: "r1", givenBy, revision },
});
const edit = (revision: bigint): UpdateBody => ({
  case: "belief",
  value: { world: "w1", editedBy: "me", revision },
});

/** A tour at the step `key`. */
function at(key: string, now: TourState): Tour {
  const tour = new Tour();
  tour.begin(now);
  const wanted = tour.steps.findIndex((step) => step.key === key);
  for (let step = 0; step < wanted; step += 1) tour.goOn(now);
  expect(tour.step.value).toBe(wanted);
  return tour;
}

function keyOf({ steps, step }: Tour): string | undefined {
  return steps[step.value ?? -1]?.key;
}

describe("the tour", () => {
  it("is none until it begins, and can be left", () => {
    const tour = new Tour();
    tour.look(tourState(1));
    expect(tour.step.value).toBeUndefined();
    tour.begin(tourState(0));
    expect(tour.step.value).toBe(0);
    tour.leave();
    expect(tour.step.value).toBeUndefined();
  });

  it("goes on when N was pressed, not before", () => {
    const tour = at("queue", tourState(3));
    tour.look(tourState(3));
    expect(keyOf(tour)).toBe("queue");
    tour.look(tourState(4));
    expect(keyOf(tour)).toBe("path");
  });

  it("goes on with my path, not with somebody else's", () => {
    const tour = at("path", tourState(0, path("me", 2n)));
    tour.look(tourState(0, path("you", 3n)));
    expect(keyOf(tour)).toBe("path");
    tour.look(tourState(0, path("me", 4n)));
    expect(keyOf(tour)).toBe("picture");
  });

  it("goes on with an edit, or an answer", () => {
    const answered: UpdateBody = { case: "snapshot", value: { robot: "r1", answeredBy: "me" } };
    for (const happened of [tourState(0, edit(1n)), tourState(0, answered)]) {
      const tour = at("wall", tourState(0));
      tour.look(happened);
      expect(keyOf(tour)).toBe("next");
    }
  });

  it("ends after its last step", () => {
    const tour = at("end", tourState(0));
    tour.goOn(tourState(0));
    expect(tour.step.value).toBeUndefined();
  });

  const using = (method: string, ...more: UpdateBody[]) =>
    tourState(0, { case: "session", value: { method, robots: ["r1"] } }, ...more);

  it("has the steps that fit the method", () => {
    const keys = (method: string) => {
      const tour = new Tour();
      tour.begin(using(method));
      return tour.steps.map(({ key }) => key);
    };
    expect(keys("ig-mcts")).toContain("picture");
    expect(keys("instruction")).toEqual(expect.arrayContaining(["path", "live view"]));
    expect(keys("teleop")).toContain("drive");
    expect(keys("teleop")).not.toContain("path");
    for (const method of ["instruction", "teleop"]) expect(keys(method)).not.toContain("picture");
  });

  it("goes on when the chosen robot was driven", () => {
    const driven = (name: string, lowLevelSteps: bigint): UpdateBody => ({
      case: "robot",
      value: { name, lowLevelSteps },
    });
    const tour = at("drive", using("teleop", driven("r1", 3n)));
    tour.look(using("teleop", driven("r1", 3n), driven("r2", 9n)));
    expect(keyOf(tour)).toBe("drive");
    tour.look(using("teleop", driven("r1", 4n)));
    expect(keyOf(tour)).toBe("wall");
  });
});
