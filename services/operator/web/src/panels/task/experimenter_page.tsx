import type { ComponentChildren } from "preact";
import { useState } from "preact/hooks";
import { useConsole } from "../../app/console";
import { LinkBanner, UndeliveredStop } from "../../app/link_banner";
import { TextField } from "../../app/text_field";
import { Role, type Task, TaskKind } from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";
import { count, playTime, timeOfDay } from "../format";
import { levelClass, levelText } from "../status/health";
import { SurveyForm } from "./form_step";
import { StepProgress } from "./task_bar";
import { TaskViews } from "./task_page";
import { goalsText, isMaze, stepStateText, stepTitle, timeLeft, timeUsed } from "./task_state";
import "./step.css";

/** The page of a study's experimenter: what the participant sees, how they get on, and what to do about it. */
export function ExperimenterPage({ map }: { map: ComponentChildren }) {
  const { task } = useConsole().store.state.value;
  return (
    <div class="console experimenter">
      <header class="top">
        <section class="panel task-bar" aria-label="Step">
          {task === undefined ? (
            <p class="quiet">Waiting for a step…</p>
          ) : (
            <StepFacts task={task} />
          )}
        </section>
      </header>
      <LinkBanner />
      <UndeliveredStop />
      <main class="stage" aria-label="What the participant sees">
        {task !== undefined && (isMaze(task) ? <div class="map">{map}</div> : <Calm task={task} />)}
      </main>
      <aside class="side" aria-label="Study">
        {task !== undefined && <StepControls task={task} />}
        <Notes />
        {task !== undefined && isMaze(task) && <TaskViews />}
        <Health />
      </aside>
    </div>
  );
}

function StepFacts({ task }: { task: Task }) {
  const { store } = useConsole();
  const state = store.state.value;
  const now = store.now.value;
  const left = timeLeft(task, now);
  const pages = pagesOfParticipant(state);
  return (
    <>
      <h1>Participant {task.participant}</h1>
      <strong>{stepTitle(state)}</strong>
      <StepProgress task={task} />
      <output class="step-state">{stepStateText(task)}</output>
      <span>
        {playTime(timeUsed(task, now))} in this step
        {left !== undefined && `, ${playTime(left)} left`}
      </span>
      {isMaze(task) && <span>{goalsText(task)}</span>}
      <span class={`end ${pages === 0 ? "bad" : "good"}`}>
        {pages === 0
          ? "○ The participant's page is not connected"
          : `● ${count(pages, "page")} of the participant connected`}
      </span>
    </>
  );
}

export function pagesOfParticipant({ presence }: ConsoleState): number {
  const people = presence?.people ?? [];
  return people.filter(({ role }) => role === Role.OPERATOR || role === Role.ADMIN).length;
}

/** A form or a rest as the participant sees it. */
function Calm({ task }: { task: Task }) {
  return (
    <section class="panel calm-copy" aria-label="Copy of the participant's page">
      {task.kind === TaskKind.TASK_FORM ? (
        <SurveyForm key={task.step} task={task} />
      ) : (
        <p>A cross to look at.</p>
      )}
    </section>
  );
}

function StepControls({ task }: { task: Task }) {
  const { store, actions } = useConsole();
  const [aborting, setAborting] = useState(false);
  const text = stepStateText(task);
  const isOver = text === "finished" || text === "aborted";
  const may = store.linked.value && !isOver;
  return (
    <section class="panel" aria-label="Control of the study">
      <h2>Control</h2>
      <div class="row">
        <button
          type="button"
          class="main"
          disabled={!may}
          onClick={() => void actions.pause(!task.paused)}
        >
          {task.paused ? "Continue" : "Pause"}
        </button>
        <button type="button" disabled={!may || aborting} onClick={() => setAborting(true)}>
          Abort…
        </button>
      </div>
      {aborting && !isOver && <AbortForm close={() => setAborting(false)} />}
    </section>
  );
}

function AbortForm({ close }: { close: () => void }) {
  const { actions } = useConsole();
  const [reason, setReason] = useState("");
  const abort = async (event: Event) => {
    event.preventDefault();
    const outcome = await actions.abort(reason.trim());
    if (outcome.accepted) close();
  };
  return (
    <form class="dialog-form" onSubmit={(event) => void abort(event)}>
      <p>This ends the participant’s session for good. The study goes on with its last part.</p>
      <TextField label="Reason" limit={300} value={reason} onValue={setReason} />
      <div class="row">
        <button type="submit" class="danger" disabled={reason.trim() === ""}>
          Abort for good
        </button>
        <button type="button" onClick={close}>
          Cancel
        </button>
      </div>
    </form>
  );
}

/** What happened in this step, and what the experimenter wrote. The participant sees none of it. */
function Notes() {
  const { store, actions } = useConsole();
  const [text, setText] = useState("");
  const entries = store.state.value.studyLog?.entries ?? [];
  const save = async (event: Event) => {
    event.preventDefault();
    const outcome = await actions.note(text.trim());
    if (outcome.accepted) setText("");
  };
  return (
    <section class="panel" aria-label="Notes">
      <h2>Notes</h2>
      <ol class="study-log">
        {entries.map(({ time, event, text: said }) => (
          <li key={`${time} ${event}`}>
            <span class="quiet">{timeOfDay(time)}</span> {event !== "note" && event}
            {event !== "note" && said !== "" && ": "}
            {said}
          </li>
        ))}
      </ol>
      <form class="row" onSubmit={(event) => void save(event)}>
        <TextField label="New note" limit={500} value={text} onValue={setText} />
        <button type="submit" disabled={text.trim() === "" || !store.linked.value}>
          Save note
        </button>
      </form>
    </section>
  );
}

function Health() {
  const { store } = useConsole();
  const { services, alerts } = store.state.value;
  const active = alerts.filter(({ active }) => active);
  return (
    <section class="panel" aria-label="Health">
      <h2>Health</h2>
      <ul>
        {active.map(({ id, source, text }) => (
          <li key={String(id)} class="bad">
            ▲ {source}: {text}
          </li>
        ))}
        {[...services.values()].map(({ name, level, message }) => (
          <li key={name}>
            <span class={levelClass(level)}>{levelText(level)}</span> {name}{" "}
            <span class="quiet">{message}</span>
          </li>
        ))}
      </ul>
    </section>
  );
}
