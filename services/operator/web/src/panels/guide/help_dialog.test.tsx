// @vitest-environment happy-dom
import { render } from "preact";
import { afterEach, describe, expect, it } from "vitest";
import { MapSigns } from "./help_dialog";

afterEach(() => render(undefined, document.body));

function told(participates: boolean, offersPaths: boolean): readonly string[] {
  render(<MapSigns participates={participates} offersPaths={offersPaths} />, document.body);
  return [...document.querySelectorAll("li")].map(({ textContent }) => textContent ?? "");
}

describe("the signs of the map", () => {
  it("each have words and something to see", () => {
    const all = told(false, true);
    expect(new Set(all).size).toBe(all.length);
    expect(document.querySelectorAll("li svg")).toHaveLength(all.length);
    expect(all.filter((text) => /robots saw/i.test(text))).toHaveLength(2);
  });

  it("of what a participant is not told are left out, and of paths where there are none", () => {
    expect(told(true, true).join()).not.toMatch(/robots saw|expected|plan|picture shown|greyed/i);
    expect(told(true, true).join()).toMatch(/path/i);
    expect(told(true, false).join()).not.toMatch(/path/i);
  });
});
