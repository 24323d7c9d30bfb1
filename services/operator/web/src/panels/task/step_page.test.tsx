// @vitest-environment happy-dom
import { render } from "preact";
import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { fakeConsole, InConsole } from "../../app/fixtures";
import { FakeConnection } from "../../connection/fake";
import { Mode, Role, TaskKind, TaskPhase } from "../../protocol/generated/console_pb";
import { type UpdateBody, updates, welcomeMessage } from "../../state/fixtures";
import { ExperimenterPage } from "./experimenter_page";
import { StepPage } from "./step_page";

beforeEach(() => {
  // happy-dom's dialogs have no showModal.
  HTMLDialogElement.prototype.showModal ??= vi.fn();
});
afterEach(() => render(undefined, document.body));

const step = { participant: "P07", number: 2, count: 9, title: "A rest", kind: TaskKind.TASK_REST };

function show(role: Role, task: object, ...more: UpdateBody[]) {
  const connection = new FakeConnection();
  const console = fakeConsole(connection);
  console.store.link.value = { state: "live" };
  const bodies: UpdateBody[] = [{ case: "task", value: { ...step, ...task } }, ...more];
  console.store.receive(welcomeMessage({ mode: Mode.STUDY, role }), updates(bodies));
  const page =
    role === Role.EXPERIMENTER ? <ExperimenterPage map={<p />} /> : <StepPage map={<p />} />;
  render(<InConsole of={console}>{page}</InConsole>, document.body);
  return connection;
}

const text = () => document.body.textContent ?? "";
const button = (name: string) =>
  [...document.querySelectorAll("button")].find(({ textContent }) => textContent?.startsWith(name));

it("a rest begins when the participant says so", () => {
  const connection = show(Role.OPERATOR, { timeLimit: 120 });
  expect(text()).toContain("Step 2 of 9");
  expect(text()).toContain("2 minutes");
  button("Begin")?.click();
  expect(connection.asked.map((body) => body.case)).toEqual(["begin"]);
});

it("a rest shows a cross and no seconds", () => {
  show(Role.OPERATOR, { phase: TaskPhase.PHASE_RUNNING, timeLimit: 120 });
  expect(document.querySelector("[role=img]")?.getAttribute("aria-label")).toMatch(/cross/);
  expect(text()).not.toMatch(/\d+:\d+|\d+ s\b/);
});

it("a pause covers the page", () => {
  show(Role.OPERATOR, { phase: TaskPhase.PHASE_RUNNING, paused: true });
  expect(document.querySelector("dialog")?.textContent).toContain("Paused");
});

it("the code comes at the end, and nothing before says what is to come", () => {
  show(Role.OPERATOR, { phase: TaskPhase.PHASE_FINISHED });
  expect(text()).toContain("Preparing the next one");
  show(Role.OPERATOR, { phase: TaskPhase.PHASE_FINISHED, number: 9, completionCode: "C-77" });
  expect(document.querySelector<HTMLInputElement>(".completion-code")?.value).toBe("C-77");
});

it("an experimenter sees who is there, what happened, and may pause", () => {
  const connection = show(
    Role.EXPERIMENTER,
    { phase: TaskPhase.PHASE_RUNNING },
    { case: "presence", value: { people: [{ client: "me", role: Role.EXPERIMENTER }] } },
    { case: "studyLog", value: { entries: [{ time: 1, event: "note", text: "looks tired" }] } },
  );
  expect(text()).toContain("Participant P07");
  expect(text()).toContain("running");
  expect(text()).toContain("not connected");
  expect(text()).toContain("looks tired");
  button("Pause")?.click();
  expect(connection.asked).toEqual([{ case: "pause", value: { on: true } }]);
});

it("an abort wants a reason", async () => {
  show(Role.EXPERIMENTER, { phase: TaskPhase.PHASE_RUNNING });
  button("Abort")?.click();
  await Promise.resolve();
  await new Promise((resolve) => setTimeout(resolve));
  expect(button("Abort for good")?.disabled).toBe(true);
});

it("a step that is over cannot be paused", () => {
  show(Role.EXPERIMENTER, { phase: TaskPhase.PHASE_FINISHED, aborted: true });
  expect(text()).toContain("aborted");
  expect(button("Pause")?.disabled).toBe(true);
});
