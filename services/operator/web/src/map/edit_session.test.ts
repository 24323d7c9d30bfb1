import fc from "fast-check";
import { describe, expect, it } from "vitest";
import {
  cancelStroke,
  canRedo,
  canUndo,
  changesOf,
  draftLayers,
  dropRefused,
  type EditSession,
  endStroke,
  mapConfirmed,
  newEditSession,
  paint,
  redo,
  replied,
  sendAgain,
  undo,
} from "./edit_session";

const size = { rows: 5, columns: 6 };
const accepted = { accepted: true, reason: "" };
const refusal = { accepted: false, reason: "based on revision 3; the current one is 4" };

function walls(...indices: number[]): Uint8Array {
  const bytes = new Uint8Array(size.rows * size.columns);
  for (const index of indices) bytes[index] = 255;
  return bytes;
}

function map(revision: number, ...wallIndices: number[]) {
  return { world: "w1", revision: BigInt(revision), walls: walls(...wallIndices) };
}

const at = (row: number, column: number) => ({ row, column });

function begin(): EditSession {
  return newEditSession(map(3), size);
}

function stroke(session: EditSession, wall: boolean, ...cells: [number, number][]): EditSession {
  return endStroke(
    paint(
      session,
      cells.map(([row, column]) => at(row, column)),
      wall,
    ),
  );
}

/** Plays the service: accepts the pending edit and shows the map with it. */
function confirm(session: EditSession): EditSession {
  const pending = session.pending;
  if (!pending) throw new Error("nothing is pending");
  const bytes = session.walls.slice();
  for (const [index, wall] of pending.draft) bytes[index] = wall ? 255 : 0;
  const shown = { world: session.world, revision: session.revision + 1n, walls: bytes };
  return mapConfirmed(replied(session, pending.id, accepted), shown, size);
}

function sent(session: EditSession) {
  return changesOf(session.pending?.draft ?? new Map(), size);
}

describe("a stroke", () => {
  it("is shown while it is drawn and sent when it ends, based on the confirmed revision", () => {
    const drawing = paint(begin(), [at(1, 1), at(1, 2)], true);
    expect(drawing.pending).toBeUndefined();
    expect(draftLayers(drawing).stroke.size).toBe(2);
    const ended = endStroke(drawing);
    expect(ended.pending?.base).toBe(3n);
    expect(sent(ended)).toEqual([
      { cell: at(1, 1), wall: true },
      { cell: at(1, 2), wall: true },
    ]);
    expect(draftLayers(ended).stroke.size).toBe(0);
  });

  it("leaves out the border and what lies outside", () => {
    const ended = stroke(begin(), true, [0, 2], [2, 0], [4, 2], [2, 5], [9, 9], [-1, 2], [2, 2]);
    expect(sent(ended)).toEqual([{ cell: at(2, 2), wall: true }]);
  });

  it("leaves out what the map already says", () => {
    const session = newEditSession(map(3, 7), size);
    expect(sent(stroke(session, true, [1, 1], [1, 2]))).toEqual([{ cell: at(1, 2), wall: true }]);
    expect(stroke(session, true, [1, 1]).pending).toBeUndefined();
  });

  it("sends a cell that is passed twice once, with its last value", () => {
    const twice = paint(paint(begin(), [at(1, 1)], false), [at(1, 1)], true);
    expect(sent(endStroke(twice))).toEqual([{ cell: at(1, 1), wall: true }]);
  });

  it("can be left", () => {
    const left = endStroke(cancelStroke(paint(begin(), [at(1, 1)], true)));
    expect(left.pending).toBeUndefined();
  });

  it("goes in parts when it is larger than an edit may be", () => {
    const cells = [at(1, 1), at(1, 2), at(1, 3)];
    const ended = endStroke(paint(begin(), cells, true), 2);
    expect(sent(ended)).toHaveLength(2);
    expect(sent(confirm(ended))).toEqual([{ cell: at(1, 3), wall: true }]);
  });
});

describe("a pending edit", () => {
  it("is saved only when it is accepted and a newer revision came, in either order", () => {
    const ended = stroke(begin(), true, [1, 1]);
    const replyFirst = replied(ended, 1, accepted);
    expect(replyFirst.pending?.accepted).toBe(true);
    expect(mapConfirmed(replyFirst, map(4, 7), size).pending).toBeUndefined();
    const mapFirst = mapConfirmed(ended, map(4, 7), size);
    expect(mapFirst.pending).toBeDefined();
    expect(replied(mapFirst, 1, accepted).pending).toBeUndefined();
  });

  it("is not settled by the map that it is based on coming again", () => {
    const ended = replied(stroke(begin(), true, [1, 1]), 1, accepted);
    expect(mapConfirmed(ended, map(3), size).pending).toBeDefined();
  });

  it("makes the next stroke wait, which then builds on the new revision", () => {
    const two = stroke(stroke(begin(), true, [1, 1]), true, [1, 2]);
    expect(sent(two)).toEqual([{ cell: at(1, 1), wall: true }]);
    expect(draftLayers(two).pending).toHaveLength(2);
    const next = confirm(two);
    expect(next.pending?.base).toBe(4n);
    expect(sent(next)).toEqual([{ cell: at(1, 2), wall: true }]);
  });

  it("ignores a reply to another edit", () => {
    const ended = stroke(begin(), true, [1, 1]);
    expect(replied(ended, 99, refusal)).toBe(ended);
  });
});

describe("a refused edit", () => {
  const refused = () => replied(stroke(begin(), true, [1, 1], [1, 2]), 1, refusal);

  it("is kept with its reason and nothing is sent by itself", () => {
    const session = refused();
    expect(session.pending).toBeUndefined();
    expect(session.refused?.reason).toBe(refusal.reason);
    expect(draftLayers(session).refused.size).toBe(2);
    expect(canUndo(session)).toBe(false);
  });

  it("is rebased on the new map: what that says already falls out", () => {
    const session = mapConfirmed(refused(), map(4, 7), size);
    expect(changesOf(draftLayers(session).refused, size)).toEqual([{ cell: at(1, 2), wall: true }]);
    expect(mapConfirmed(session, map(5, 7, 8), size).refused).toBeUndefined();
  });

  it("is rebased too when the new map came before the refusal", () => {
    const session = mapConfirmed(stroke(begin(), true, [1, 1], [1, 2]), map(4, 7), size);
    expect(draftLayers(replied(session, 1, refusal)).refused.size).toBe(1);
  });

  it("can be sent again, based on the new revision", () => {
    const again = sendAgain(mapConfirmed(refused(), map(4, 7), size));
    expect(again.refused).toBeUndefined();
    expect(again.pending?.base).toBe(4n);
    expect(sent(again)).toEqual([{ cell: at(1, 2), wall: true }]);
    expect(confirm(again).undo).toHaveLength(1);
  });

  it("can be dropped; without one, both do nothing", () => {
    expect(dropRefused(refused()).refused).toBeUndefined();
    expect(sendAgain(begin()).pending).toBeUndefined();
  });

  it("gives way to a newer stroke over the same cells", () => {
    const session = stroke(refused(), false, [1, 1]);
    expect(changesOf(draftLayers(session).refused, size)).toEqual([{ cell: at(1, 2), wall: true }]);
  });

  it("is joined by what is refused next", () => {
    const second = stroke(refused(), true, [2, 2]);
    const session = replied(second, second.lastId, { accepted: false, reason: "" });
    expect(draftLayers(session).refused.size).toBe(3);
    expect(session.refused?.reason).not.toBe("");
  });

  it("does not block the queue", () => {
    const two = stroke(stroke(begin(), true, [1, 1]), true, [1, 2]);
    const session = replied(two, 1, refusal);
    expect(sent(session)).toEqual([{ cell: at(1, 2), wall: true }]);
  });
});

describe("undo and redo", () => {
  it("send the inverse and the edit again", () => {
    const done = confirm(stroke(newEditSession(map(3, 8), size), true, [1, 1], [1, 2]));
    const undoing = undo(done);
    expect(sent(undoing)).toEqual([{ cell: at(1, 1), wall: false }]);
    const undone = confirm(undoing);
    expect(canUndo(undone)).toBe(false);
    expect(sent(redo(undone))).toEqual([{ cell: at(1, 1), wall: true }]);
    expect(canUndo(confirm(redo(undone)))).toBe(true);
    expect(canRedo(confirm(redo(undone)))).toBe(false);
  });

  it("wait for what is under way", () => {
    const session = undo(stroke(begin(), true, [1, 1]));
    expect(canUndo(session)).toBe(false);
    const undoing = confirm(session);
    expect(undoing.pending?.kind).toBe("undo");
    expect([...confirm(undoing).walls]).toEqual([...walls()]);
  });

  it("leave alone what others have changed since", () => {
    const done = confirm(stroke(begin(), true, [1, 1], [1, 2]));
    const others = mapConfirmed(done, map(5, 8), size);
    expect(sent(undo(others))).toEqual([{ cell: at(1, 2), wall: false }]);
  });

  it("go to the step before when others have changed all of the last one", () => {
    const two = confirm(stroke(confirm(stroke(begin(), true, [1, 1])), true, [1, 2]));
    const others = mapConfirmed(two, map(6, 7), size);
    expect(sent(undo(others))).toEqual([{ cell: at(1, 1), wall: false }]);
  });

  it("do nothing where there is nothing", () => {
    expect(undo(begin())).toEqual(begin());
    expect(redo(begin())).toEqual(begin());
  });

  it("a new stroke ends what could be redone", () => {
    const undone = confirm(undo(confirm(stroke(begin(), true, [1, 1]))));
    expect(canRedo(undone)).toBe(true);
    const drawn = stroke(undone, true, [2, 2]);
    expect(canRedo(drawn)).toBe(false);
    expect(canRedo(confirm(drawn))).toBe(false);
  });

  it("a refused undo stays possible", () => {
    const undoing = undo(confirm(stroke(begin(), true, [1, 1])));
    const session = replied(undoing, undoing.lastId, refusal);
    expect(canUndo(session)).toBe(true);
    expect(draftLayers(session).refused.size).toBe(1);
  });
});

describe("redo", () => {
  const twice = () => {
    const drawn = confirm(stroke(confirm(stroke(begin(), true, [1, 1])), true, [1, 2]));
    return confirm(undo(confirm(undo(drawn))));
  };

  it("leaves the steps that were undone before it", () => {
    const once = confirm(redo(twice()));
    expect([canUndo(once), canRedo(once)]).toEqual([true, true]);
    const all = confirm(redo(once));
    expect([canUndo(all), canRedo(all)]).toEqual([true, false]);
    expect(all.walls).toEqual(walls(7, 8));
  });

  it("is over with the next stroke, for all that was undone", () => {
    expect(canRedo(confirm(stroke(twice(), true, [2, 2])))).toBe(false);
  });
});

describe("another world, or a restarted service", () => {
  it("or another maze with the same name starts from scratch", () => {
    const session = confirm(stroke(begin(), true, [1, 1]));
    const larger = { rows: 6, columns: 6 };
    const shown = { world: "w1", revision: 9n, walls: new Uint8Array(36) };
    const next = mapConfirmed(session, shown, larger);
    expect([next.size, next.undo]).toEqual([larger, []]);
  });

  it("forgets drafts and steps, and never gives an id twice", () => {
    const session = stroke(begin(), true, [1, 1]);
    const other = mapConfirmed(session, { ...map(9), world: "w2" }, size);
    expect(other.pending).toBeUndefined();
    expect(stroke(other, true, [1, 1]).pending?.id).toBe(2);
    expect(mapConfirmed(session, map(0), size).pending).toBeUndefined();
  });
});

it("whatever is drawn, undoing all of it brings the first map back", () => {
  const cell = fc.tuple(fc.nat(4), fc.nat(5), fc.boolean());
  fc.assert(
    fc.property(fc.array(cell, { maxLength: 12 }), (cells) => {
      let session = newEditSession(map(3, 8, 15), size);
      for (const [row, column, wall] of cells) {
        session = stroke(session, wall, [row, column]);
        if (session.pending) session = confirm(session);
      }
      while (canUndo(session)) session = confirm(undo(session));
      expect([...session.walls]).toEqual([...walls(8, 15)]);
    }),
  );
});
