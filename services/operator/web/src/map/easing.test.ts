import { expect, it } from "vitest";
import { Easing } from "./easing";
import { at, robotIn } from "./fixtures";

const r1 = (x: number, heading = 0) => {
  const one = robotIn("r1", at(1, 1));
  return { ...one, robot: { ...one.robot, x, y: 0, heading } };
};
const xOf = (easing: Easing, x: ReturnType<typeof r1>, now: number) => {
  const { robots, moving } = easing.at([x], now);
  return [robots[0]?.robot.x, moving];
};

it("a robot glides to its newest report in the time between the last two", () => {
  const easing = new Easing();
  expect(xOf(easing, r1(0), 10)).toEqual([0, false]);
  const next = r1(0.2);
  expect(xOf(easing, next, 10.25)).toEqual([0, true]);
  expect(xOf(easing, next, 10.375)[0]).toBeCloseTo(0.1);
  expect(xOf(easing, next, 10.5)).toEqual([0.2, false]);
});

it("a report on the way begins where the robot is drawn, and headings turn the shorter way", () => {
  const easing = new Easing();
  easing.at([r1(0, 3)], 10);
  const second = r1(0.2, -3);
  easing.at([second], 10.2);
  const middle = easing.at([second], 10.3).robots[0]?.robot;
  expect(Math.abs(middle?.heading ?? 0)).toBeGreaterThan(3);
  const third = r1(0.4, -3);
  expect(easing.at([third], 10.3).robots[0]?.robot.x).toBeCloseTo(0.1);
});

it("fast reports, a long silence and robots that were moved are shown at once", () => {
  const easing = new Easing();
  easing.at([r1(0)], 10);
  expect(xOf(easing, r1(0.1), 10.05)).toEqual([0.1, false]);
  expect(xOf(easing, r1(0.2), 12)).toEqual([0.2, false]);
  expect(xOf(easing, r1(9), 12.2)).toEqual([9, false]);
});
