import { beforeEach, describe, expect, it } from "vitest";
import { type PixelReply, Pixels } from "./pixels";

let asked: [string, Record<string, string>][];
let revoked: string[];
let made: number;
let reply: PixelReply;

beforeEach(() => {
  asked = [];
  revoked = [];
  made = 0;
  reply = { ok: true, status: 200, blob: () => Promise.resolve(new Blob()) };
});

function pixels(token = "") {
  return new Pixels({
    token,
    fetch: (path, { headers }) => {
      asked.push([path, headers]);
      return Promise.resolve(reply);
    },
    createUrl: () => {
      made += 1;
      return `blob:${made}`;
    },
    revokeUrl: (url) => revoked.push(url),
  });
}

const key = (sequence: bigint, robot = "r1", run = "run-1") => ({ run, robot, sequence });
const settled = () => new Promise((resolve) => setTimeout(resolve, 0));

describe("pixels", () => {
  it("are fetched once for all who show them", async () => {
    const all = pixels();
    const first = all.acquire(key(7n));
    expect(first.value.kind).toBe("loading");
    expect(all.acquire(key(7n))).toBe(first);
    await settled();
    expect(first.value).toEqual({ kind: "ready", url: "blob:1" });
    expect(asked).toEqual([["/pictures/r1/7.jpg", {}]]);
  });

  it("of another run are others, though the service calls them the same", async () => {
    const all = pixels();
    const first = all.acquire(key(1n));
    await settled();
    const second = all.acquire(key(1n, "r1", "run-2"));
    expect(second.value.kind).toBe("loading");
    await settled();
    expect([first.value, second.value]).toMatchObject([{ url: "blob:1" }, { url: "blob:2" }]);
  });

  it("come with the token where there is one", () => {
    pixels("secret").acquire(key(1n, "r/1"));
    expect(asked).toEqual([["/pictures/r%2F1/1.jpg", { Authorization: "Bearer secret" }]]);
  });

  it("are revoked when many others were used since", async () => {
    const all = pixels();
    for (let i = 1n; i <= 34n; i += 1n) {
      all.acquire(key(i));
      await settled();
      all.release(key(i));
    }
    expect(revoked).toEqual(["blob:1", "blob:2"]);
  });

  it("stay while somebody shows them", async () => {
    const all = pixels();
    all.acquire(key(0n));
    for (let i = 1n; i <= 40n; i += 1n) {
      all.acquire(key(i));
      await settled();
      all.release(key(i));
    }
    expect(revoked).not.toContain("blob:1");
  });

  it("that are missing are fetched again next time", async () => {
    reply = { ok: false, status: 404, blob: () => Promise.reject(new Error()) };
    const all = pixels();
    const state = all.acquire(key(1n));
    await settled();
    expect(state.value).toMatchObject({ kind: "missing" });
    all.acquire(key(1n));
    expect(asked).toHaveLength(2);
  });
});
