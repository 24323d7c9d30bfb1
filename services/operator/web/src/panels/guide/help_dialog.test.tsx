// @vitest-environment happy-dom
import { render } from "preact";
import { afterEach, describe, expect, it } from "vitest";
import { MapSigns } from "./help_dialog";
import { signs } from "./sign_table";

afterEach(() => render(undefined, document.body));

function shown(participates: boolean, offersPaths: boolean): readonly string[] {
  render(<MapSigns participates={participates} offersPaths={offersPaths} />, document.body);
  return [...document.querySelectorAll("li")].map(({ lastChild }) => lastChild?.textContent ?? "");
}

describe("the map symbols", () => {
  it("each have a text and a drawing", () => {
    const all = shown(false, true);
    expect(new Set(all).size).toBe(all.length);
    expect(document.querySelectorAll("li svg")).toHaveLength(all.length);
  });

  it("leave out secrets for participants, and paths where there are none", () => {
    const open = signs.filter(({ secret }) => !secret);
    expect(open.length).toBeLessThan(signs.length);
    expect(shown(true, true)).toEqual(open.map(({ text }) => text));
    expect(shown(true, false).join()).not.toMatch(/path/i);
  });
});
