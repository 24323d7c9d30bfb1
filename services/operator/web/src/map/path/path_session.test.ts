import fc from "fast-check";
import { describe, expect, it } from "vitest";
import { type Cell, contains, distance } from "../grid";
import {
  addRoute,
  adopt,
  beginDrawing,
  bendTo,
  canGrab,
  continueDrawing,
  drawTo,
  endBend,
  endDrawing,
  grab,
  guidanceCame,
  isLeft,
  leave,
  newPathSession,
  type PathSession,
  removeVertex,
  replied,
  robotMoved,
  send,
  vertices,
  withdraw,
} from "./path_session";
import type { RouteGrid } from "./routes";

const accepted = { accepted: true, reason: "" };

function gridOf(...rows: string[]): RouteGrid {
  const text = rows.join("");
  return {
    size: { rows: rows.length, columns: rows[0]?.length ?? 0 },
    walls: Uint8Array.from(text, (letter) => (letter === "#" ? 255 : 0)),
  };
}

const open = gridOf("#######", "#.....#", "#.....#", "#.....#", "#.....#", "#######");
const at = (row: number, column: number): Cell => ({ row, column });
const pairs = (session: PathSession) => session.cells.map((cell) => [cell.row, cell.column]);
const fresh = () => newPathSession("r1", at(1, 1));

function drawn(...cells: [number, number][]): PathSession {
  const path = cells.map(([row, column]) => at(row, column));
  return endDrawing(path.reduce((now, cell) => drawTo(now, open, cell), beginDrawing(fresh())));
}

const corner = () => drawn([1, 1], [1, 2], [1, 3], [2, 3], [3, 3]);

describe("drawing", () => {
  it("follows the pointer from the robot", () => {
    expect(pairs(corner())).toEqual([
      [1, 1],
      [1, 2],
      [1, 3],
      [2, 3],
      [3, 3],
    ]);
  });

  it("removes steps that the pointer moves back over", () => {
    expect(pairs(drawn([1, 1], [1, 2], [1, 3], [1, 2]))).toEqual([
      [1, 1],
      [1, 2],
    ]);
  });

  it("leads back where the pointer goes back over what was there before", () => {
    const back = [at(4, 3), at(3, 3), at(2, 3), at(1, 3)];
    const out = back.reduce((path, cell) => drawTo(path, open, cell), continueDrawing(corner()));
    expect(pairs(out)).toEqual([...pairs(corner()), [2, 3], [1, 3]]);
  });

  it("continues at the end of a draft, and starts over at the robot", () => {
    const more = endDrawing(drawTo(continueDrawing(corner()), open, at(4, 3)));
    expect(pairs(more).at(-1)).toEqual([4, 3]);
    expect(more.cells).toHaveLength(6);
    expect(beginDrawing(corner()).cells).toEqual([at(1, 1)]);
    expect(continueDrawing(fresh())).toEqual(fresh());
  });

  it("a press on the robot alone is no path", () => {
    expect(drawn([1, 1]).cells).toEqual([]);
  });

  it("by keys joins cells by the shortest route around walls", () => {
    const walled = gridOf("#######", "#.#...#", "#.#.#.#", "#...#.#", "#######");
    const path = addRoute(newPathSession("r1", at(1, 1)), walled, at(1, 3));
    expect(path.cells).toHaveLength(7);
  });

  it("does nothing between strokes", () => {
    expect(drawTo(corner(), open, at(4, 4))).toEqual(corner());
  });

  it("stays in the grid", () => {
    expect(pairs(drawn([1, 1], [1, 30])).at(-1)).toEqual([1, 6]);
  });
});

describe("bending", () => {
  it("has its vertices at the corners and ends", () => {
    expect(vertices(corner().cells)).toEqual([0, 2, 4]);
    expect(vertices([])).toEqual([]);
  });

  it("moves a corner, the ends stay", () => {
    const bent = endBend(bendTo(grab(corner(), at(1, 3)), open, at(3, 1)));
    expect(pairs(bent)).toContainEqual([3, 1]);
    expect(pairs(bent).at(-1)).toEqual([3, 3]);
    expect(pairs(bent)[0]).toEqual([1, 1]);
  });

  it("in between makes a new vertex", () => {
    const bent = endBend(bendTo(grab(corner(), at(1, 2)), open, at(2, 2)));
    expect(pairs(bent)).toContainEqual([2, 2]);
    expect(pairs(bent)).toContainEqual([1, 3]);
  });

  it("moves the end", () => {
    const bent = endBend(bendTo(grab(corner(), at(3, 3)), open, at(3, 5)));
    expect(pairs(bent).at(-1)).toEqual([3, 5]);
  });

  it("does not take hold of the robot's cell or of what is not on the path", () => {
    expect(canGrab(corner(), at(1, 1))).toBe(false);
    expect(canGrab(corner(), at(4, 4))).toBe(false);
    expect(bendTo(grab(corner(), at(4, 4)), open, at(2, 2))).toEqual(corner());
  });

  it("back to the robot leaves no path", () => {
    const short = drawn([1, 1], [1, 2]);
    expect(endBend(bendTo(grab(short, at(1, 2)), open, at(1, 1))).cells).toEqual([]);
  });
});

describe("removing", () => {
  it("the end shortens to the vertex before", () => {
    expect(pairs(removeVertex(corner(), open)).at(-1)).toEqual([1, 3]);
  });

  it("a corner takes another route of the same length, and keeps the ends", () => {
    const other = removeVertex(corner(), open, at(1, 3));
    expect(pairs(other)).not.toContainEqual([1, 3]);
    expect(other.cells).toHaveLength(5);
    expect(pairs(other).at(-1)).toEqual([3, 3]);
  });

  it("a detour takes the shortest route", () => {
    const back = addRoute(addRoute(fresh(), open, at(4, 1)), open, at(2, 1));
    expect(back.cells).toHaveLength(6);
    expect(pairs(removeVertex(back, open, at(4, 1)))).toEqual([
      [1, 1],
      [2, 1],
    ]);
  });

  it("all of it leaves none; what is not on the path does nothing", () => {
    expect(removeVertex(drawn([1, 1], [1, 2]), open).cells).toEqual([]);
    expect(removeVertex(corner(), open, at(4, 4))).toEqual(corner());
    expect(removeVertex(fresh(), open)).toEqual(fresh());
  });
});

describe("a robot that moves", () => {
  it("onto all that is drawn does not end the drawing", () => {
    const begun = drawTo(beginDrawing(fresh()), open, at(1, 2));
    const there = robotMoved(begun, open, at(1, 2));
    expect(pairs(there)).toEqual([[1, 2]]);
    expect(pairs(drawTo(there, open, at(1, 3)))).toEqual([
      [1, 2],
      [1, 3],
    ]);
    expect(robotMoved(endDrawing(begun), open, at(1, 2)).cells).toEqual([]);
  });

  it("leaves what it has passed behind", () => {
    expect(pairs(robotMoved(corner(), open, at(1, 3)))[0]).toEqual([1, 3]);
  });

  it("off the path gets a route to what was drawn, which is sent up to three steps", () => {
    const near = robotMoved(corner(), open, at(2, 1));
    expect(pairs(near).slice(0, 2)).toEqual([
      [2, 1],
      [1, 1],
    ]);
    expect([near.undrawn, isLeft(near)]).toEqual([1, false]);
    const far = robotMoved(robotMoved(near, open, at(3, 1)), open, at(4, 1));
    expect([far.undrawn, isLeft(far), send(far).sent !== undefined]).toEqual([3, false, true]);
    const farther = robotMoved(far, open, at(4, 2));
    expect([farther.undrawn, isLeft(farther), send(farther)]).toEqual([4, true, farther]);
    expect(robotMoved(farther, open, at(1, 2)).undrawn).toBe(0); // it came upon the path
  });

  it("that returns to where the hand took it over has what the hand drew from there", () => {
    const begun = beginDrawing(newPathSession("r1", at(2, 2)));
    const away = robotMoved(begun, open, at(2, 1));
    const back = robotMoved(drawTo(away, open, at(2, 1)), open, at(2, 2));
    expect(back.cells).toEqual([at(2, 2), at(2, 1)]);
    expect(back.undrawn).toBe(0);
  });

  it("at the end of the path has none left", () => {
    expect(robotMoved(corner(), open, at(3, 3)).cells).toEqual([]);
  });
});

describe("sending", () => {
  it("that is refused brings the path back, even if the draft was dropped", () => {
    const sent = send(corner());
    const left = leave(sent);
    expect(left.cells).toEqual([]);
    const refused = replied(left, 1, { accepted: false, reason: "a wall" });
    expect(pairs(refused)).toEqual(pairs(corner()));
  });

  it("keeps the draft until it is accepted and shown, in either order", () => {
    const sent = send(corner());
    expect(sent.sent?.cells).toEqual(corner().cells);
    const replyFirst = replied(sent, 1, accepted);
    expect(replyFirst.cells).not.toEqual([]);
    expect(guidanceCame(replyFirst, 4n)).toMatchObject({ cells: [], sent: undefined });
    expect(replied(guidanceCame(sent, 4n), 1, accepted).cells).toEqual([]);
  });

  it("settles also when the robot has moved", () => {
    const moved = robotMoved(send(corner()), open, at(1, 2));
    expect(guidanceCame(replied(moved, 1, accepted), 4n).cells).toEqual([]);
  });

  it("keeps what is refused, with the reason", () => {
    const refused = replied(send(corner()), 1, { accepted: false, reason: "observer" });
    expect(refused.refusal).toBe("observer");
    expect(refused.cells).toEqual(corner().cells);
    expect(send(refused).refusal).toBeUndefined();
  });

  it("keeps a newer draft", () => {
    const again = beginDrawing(send(corner()));
    const drawing = drawTo(again, open, at(2, 1));
    expect(guidanceCame(replied(drawing, 1, accepted), 4n).cells).toEqual(drawing.cells);
  });

  it("ignores the reply to a path that was replaced", () => {
    const twice = send(send(corner()));
    expect(replied(twice, 1, { accepted: false, reason: "late" })).toBe(twice);
  });

  it("needs a draft; withdrawing needs none", () => {
    expect(send(fresh()).sent).toBeUndefined();
    const gone = withdraw(corner());
    expect(gone.cells).toEqual([]);
    expect(gone.sent?.cells).toEqual([]);
  });

  it("leaving drops the draft and sends nothing", () => {
    expect(leave(corner())).toMatchObject({ cells: [], sent: undefined });
  });
});

describe("the path that the robot has", () => {
  it("is taken up from where the robot is", () => {
    expect(pairs(adopt(fresh(), open, [at(2, 1), at(1, 1), at(1, 2)]))).toEqual([
      [1, 1],
      [1, 2],
    ]);
    expect(adopt(fresh(), open, []).cells).toEqual([]);
  });
});

it("whatever is done, the draft is 4-connected, begins at the robot and stays in the grid", () => {
  const size = { rows: 6, columns: 7 };
  const anyCell = fc.record({
    row: fc.integer({ min: -1, max: 6 }),
    column: fc.integer({ min: -1, max: 7 }),
  });
  const inside = fc.record({ row: fc.nat(5), column: fc.nat(6) });
  const kinds = [
    "begin",
    "continue",
    "draw",
    "end",
    "add",
    "grab",
    "bend",
    "endBend",
    "remove",
    "send",
  ];
  const step = fc.record({
    kind: fc.constantFrom(...kinds, "move", "adopt"),
    cell: anyCell,
    inside,
  });
  const bytes = fc.uint8Array({ minLength: 42, maxLength: 42 });
  fc.assert(
    fc.property(bytes, inside, fc.array(step, { maxLength: 25 }), (walls, start, steps) => {
      const grid = { size, walls };
      let session = newPathSession("r1", start);
      for (const { kind, cell, inside: other } of steps) {
        session = played(session, grid, kind, cell, other);
        const { cells } = session;
        if (cells.length > 0) expect(cells[0]).toEqual(session.start);
        expect(session.undrawn).toBeLessThanOrEqual(Math.max(0, cells.length - 1));
        expect(cells.every((one) => contains(size, one))).toBe(true);
        expect(cells.every((one, i) => i === 0 || distance(one, cells[i - 1] ?? one) === 1)).toBe(
          true,
        );
      }
    }),
    { numRuns: 400 },
  );
});

function played(
  session: PathSession,
  grid: RouteGrid,
  kind: string,
  cell: Cell,
  inside: Cell,
): PathSession {
  const steps: Record<string, () => PathSession> = {
    begin: () => beginDrawing(session),
    continue: () => continueDrawing(session),
    draw: () => drawTo(session, grid, cell),
    end: () => endDrawing(session),
    add: () => addRoute(session, grid, cell),
    grab: () => grab(session, cell),
    bend: () => bendTo(session, grid, cell),
    endBend: () => endBend(session),
    remove: () => removeVertex(session, grid, cell),
    send: () => send(session),
    move: () => robotMoved(session, grid, inside),
    adopt: () => adopt(session, grid, [inside]),
  };
  return steps[kind]?.() ?? session;
}
