import { beforeEach, describe, expect, it } from "vitest";
import { FakeClock } from "../../connection/fake";
import { Severity } from "../../protocol/generated/console_pb";
import { emptyState } from "../../state/console_state";
import { stateOf, type UpdateBody } from "../../state/fixtures";
import { Announcer, announcementsOf } from "./announcer";

const session: UpdateBody = { case: "session", value: {} };
const queue = (...items: [string, number][]): UpdateBody => ({
  case: "attention",
  value: { items: items.map(([robot, reason]) => ({ robot, reason })) },
});
const alert = (id: bigint, more = {}): UpdateBody => ({
  case: "alert",
  value: { id, source: "r1", text: "silent", active: true, severity: Severity.ALARM, ...more },
});

describe("announcements", () => {
  const texts = (before: UpdateBody[], after: UpdateBody[]) =>
    announcementsOf(stateOf(session, ...before), stateOf(session, ...after)).map(
      ({ text }) => text,
    );

  it("are new items, not old ones in another order", () => {
    expect(texts([queue(["r1", 1])], [queue(["r2", 2], ["r1", 1])])).toEqual([
      expect.stringMatching(/^r2 /),
    ]);
  });

  it("are another reason of the same robot too", () => {
    expect(texts([queue(["r1", 1])], [queue(["r1", 2])])).toHaveLength(1);
  });

  it("are the same question when it is asked again", () => {
    const asked = (since: number, newestSnapshot = 1n): UpdateBody => ({
      case: "attention",
      value: { items: [{ robot: "r1", reason: 1, since, newestSnapshot }] },
    });
    expect(texts([asked(10)], [asked(20)])).toHaveLength(1);
    expect(texts([asked(10)], [asked(10, 2n)])).toHaveLength(1);
    expect(texts([asked(10)], [asked(10)])).toEqual([]);
  });

  it("are new and returning alerts, except acknowledged and shelved ones", () => {
    expect(texts([alert(1n)], [alert(1n), alert(2n)])).toEqual([
      expect.stringMatching(/r1.*silent/),
    ]);
    expect(texts([alert(1n, { active: false })], [alert(1n)])).toHaveLength(1);
    expect(texts([], [alert(1n, { acknowledgedBy: "you" })])).toEqual([]);
    expect(texts([], [alert(1n, { newest: 50, shelvedUntil: 60 })])).toEqual([]);
    expect(texts([], [alert(1n, { newest: 70, shelvedUntil: 60 })])).toHaveLength(1);
  });

  it("are none when the page opens", () => {
    expect(announcementsOf(emptyState, stateOf(session, alert(1n)))).toEqual([]);
  });
});

describe("announcer", () => {
  let clock: FakeClock;
  let announcer: Announcer;
  const say = (...texts: string[]) =>
    announcer.announce(texts.map((text) => ({ text, urgent: false })));

  beforeEach(() => {
    clock = new FakeClock();
    announcer = new Announcer(clock);
  });

  it("announces the first at once, and joins those that follow quickly", () => {
    say("a");
    expect(announcer.polite.value).toBe("a");
    say("b");
    clock.advance(1);
    say("c");
    expect(announcer.polite.value).toBe("a");
    clock.advance(3);
    expect(announcer.polite.value).toBe("b. c");
  });

  it("counts what is too much to be read", () => {
    say("a", "b", "c", "d", "e");
    expect(announcer.polite.value).toMatch(/^a\. b\. c\. .*2/);
  });

  it("says at once again after a pause", () => {
    say("a");
    clock.advance(10);
    say("b");
    expect(announcer.polite.value).toBe("b");
  });

  it("lets the same be read again when it happens again", () => {
    say("a");
    clock.advance(10);
    say("a");
    expect(announcer.polite.value).not.toBe("a");
    expect(announcer.polite.value.trim()).toBe("a");
    clock.advance(10);
    say("a");
    expect(announcer.polite.value).toBe("a");
  });

  it("interrupts only for what is urgent", () => {
    announcer.announce([{ text: "fire", urgent: true }]);
    expect(announcer.urgent.value).toBe("fire");
    expect(announcer.polite.value).toBe("");
  });
});
