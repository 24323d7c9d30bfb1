import { expect, it } from "vitest";
import { freehandRoute, type RouteGrid, route, shortestRoute } from "./routes";

function gridOf(...rows: string[]): RouteGrid {
  return {
    size: { rows: rows.length, columns: rows[0]?.length ?? 0 },
    walls: Uint8Array.from(rows.join(""), (letter) => (letter === "#" ? 255 : 0)),
  };
}

const at = (row: number, column: number) => ({ row, column });
const room = gridOf("..#..", "..#..", ".....");
const shut = gridOf("..#..", "..#..", "..#..");

it("the shortest route goes around walls and has both ends", () => {
  expect(shortestRoute(room, at(0, 1), at(0, 3))).toEqual([
    at(0, 1),
    at(1, 1),
    at(2, 1),
    at(2, 2),
    at(2, 3),
    at(1, 3),
    at(0, 3),
  ]);
  expect(shortestRoute(room, at(0, 0), at(0, 0))).toEqual([at(0, 0)]);
});

it("there is none through a wall or out of the grid, but one to or from a wall", () => {
  expect(shortestRoute(shut, at(0, 1), at(0, 3))).toBeUndefined();
  expect(shortestRoute(room, at(0, 0), at(9, 9))).toBeUndefined();
  expect(shortestRoute(shut, at(0, 0), at(0, 2))).toHaveLength(3);
  expect(shortestRoute(shut, at(0, 2), at(0, 0))).toHaveLength(3);
});

it("a route goes straight through walls where there is no other", () => {
  expect(route(shut, at(0, 1), at(0, 3))).toEqual([at(0, 1), at(0, 2), at(0, 3)]);
});

it("a line drawn by hand takes no detour around a wall, but the open side of a corner", () => {
  expect(freehandRoute(room, at(0, 1), at(0, 3))).toEqual([at(0, 1), at(0, 2), at(0, 3)]);
  const corner = gridOf(".#", "..");
  expect(freehandRoute(corner, at(0, 0), at(1, 1))).toEqual([at(0, 0), at(1, 0), at(1, 1)]);
});
