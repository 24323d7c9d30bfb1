// @vitest-environment happy-dom
import { afterEach, expect, it } from "vitest";
import { type FormEvents, type ShownForm, showForm } from "./survey";

const form = JSON.stringify({
  version: 2,
  scoring: { sum: { kind: "mean", of: ["age"] } },
  pages: [
    { elements: [{ type: "text", name: "name", title: "Your name" }] },
    {
      elements: [
        { type: "text", name: "age", title: "Your age", isRequired: true },
        { type: "text", name: "check", title: "Write yes", attention: "yes" },
      ],
    },
  ],
});

let shown: ShownForm | undefined;
afterEach(() => {
  shown?.close();
  document.body.textContent = "";
});

async function show(answers: object, events?: FormEvents, language = "en") {
  const place = document.body.appendChild(document.createElement("div"));
  shown = await showForm(place, form, language, answers, events);
  return place;
}

const deaf: FormEvents = { changed: () => undefined, completed: () => undefined };

it("a form that was filled in half goes on at its first gap", async () => {
  expect((await show({}, deaf)).textContent).toContain("Your name");
  shown?.close();
  const later = await show({ name: "P07" }, deaf);
  expect(later.textContent).toContain("Your age");
  expect(later.textContent).not.toContain("Your name");
});

it("is read only for an experimenter, all pages at once, with the newest answers", async () => {
  const place = await show({ name: "first" });
  expect(place.textContent).toContain("Your name");
  expect(place.textContent).toContain("Your age");
  expect([...place.querySelectorAll("input")].every((field) => field.readOnly)).toBe(true);
  shown?.show({ name: "second" });
  await new Promise((resolve) => setTimeout(resolve));
  expect(place.querySelector("input")?.value).toBe("second");
});

it.each([
  ["de", "Weiter"],
  ["de-AT", "Weiter"],
  ["pt-BR", "Próximo"],
  ["zh", "下一页"],
  ["zh-TW", "下一頁"],
  ["tlh", "Next"],
])("speaks the language of the study: %s", async (language, next) => {
  const place = await show({}, deaf, language);
  expect(place.querySelector(`input[value="${next}"]`)?.outerHTML).toBeDefined();
});
