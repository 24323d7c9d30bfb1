// @vitest-environment happy-dom
import { render } from "preact";
import { afterEach, describe, expect, it, vi } from "vitest";
import { setWords, translator } from "./words";

const german = {
  Begin: "Beginnen",
  maze: "Labyrinth",
  "Step {} of {}": "Schritt {} von {}",
  "Finish this {}": "Dieses {} beenden",
  "if nothing is new.": ", wenn nichts neu ist.",
};

describe("a text", () => {
  const say = translator(german);

  it("has a word, with the blanks around it", () => {
    expect(say("Begin")).toBe("Beginnen");
    expect(say(" Begin ")).toBe(" Beginnen ");
    expect(say(" if nothing is new.")).toBe(", wenn nichts neu ist.");
    expect(say("End")).toBeUndefined();
    expect(say("toString")).toBeUndefined();
  });

  it("has gaps, whose texts are looked up too", () => {
    expect(say("Step 3 of 10")).toBe("Schritt 3 von 10");
    expect(say("Finish this maze")).toBe("Dieses Labyrinth beenden");
    expect(say("Finish this part")).toBe("Dieses part beenden");
  });
});

describe("the page", () => {
  afterEach(() => setWords({}));

  it("shows words in texts and attributes, and names what has none", () => {
    const named = vi.spyOn(console, "info").mockImplementation(() => {});
    setWords(german);
    const Page = () => (
      <p title="Begin">
        Begin <img alt="Step 1 of 2" /> {3} Another one
      </p>
    );
    const root = document.createElement("div");
    render(<Page />, root);
    render(<Page />, root);
    expect(root.innerHTML).toBe(
      '<p title="Beginnen">Beginnen <img alt="Schritt 1 von 2"> 3 Another one</p>',
    );
    expect(named.mock.calls).toEqual([["no words for:  Another one"]]);
  });
});
