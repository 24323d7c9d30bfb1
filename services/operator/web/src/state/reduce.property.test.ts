import fc from "fast-check";
import { expect, it } from "vitest";
import { type ConsoleState, emptyState } from "./console_state";
import { type UpdateBody, updates } from "./fixtures";
import { reduce } from "./reduce";

const name = fc.constantFrom("r1", "r2", "r3");
const id = fc.bigInt({ min: 1n, max: 6n });
const body: fc.Arbitrary<UpdateBody> = fc.oneof(
  fc.record({ case: fc.constant("robot" as const), value: fc.record({ name, x: fc.integer() }) }),
  fc.record({
    case: fc.constant("picture" as const),
    value: fc.record({ robot: name, sequenceNumber: id, answer: fc.nat(3) }),
  }),
  fc.record({ case: fc.constant("event" as const), value: fc.record({ id, text: fc.string() }) }),
  fc.record({
    case: fc.constant("trail" as const),
    value: fc.record({ robot: name, first: fc.nat(9) }),
  }),
);

function keysOf({ pictures, events }: ConsoleState): bigint[][] {
  const numbers = [...pictures.values()].map((all) => all.map((each) => each.sequenceNumber));
  return [...numbers, events.map((event) => event.id)];
}

it("the same updates make the same state, however they are put into messages", () => {
  fc.assert(
    fc.property(fc.array(body), fc.nat(40), (bodies, cut) => {
      const at = Math.min(cut, bodies.length);
      const first = updates(bodies.slice(0, at));
      const second = updates(bodies.slice(at), BigInt(at + 1));
      const together = reduce(emptyState, updates(bodies));
      expect(reduce(reduce(emptyState, first), second)).toEqual(together);
    }),
  );
});

it("an update that comes twice changes nothing, and lists stay in order without doubles", () => {
  fc.assert(
    fc.property(fc.array(body), body, (bodies, again) => {
      const once = reduce(emptyState, updates([...bodies, again]));
      const twice = reduce(once, updates([again], BigInt(bodies.length + 1)));
      expect(twice).toEqual(once);
      for (const keys of keysOf(twice)) {
        expect([...new Set(keys)].sort((a, b) => Number(a - b))).toEqual(keys);
      }
    }),
  );
});
