import type { ComponentChildren } from "preact";
import { useEffect, useId, useRef } from "preact/hooks";
import { useConsole } from "../../app/console";
import { LinkBanner } from "../../app/link_banner";
import { type Task, TaskKind, TaskPhase } from "../../protocol/generated/console_pb";
import { FormStep } from "./form_step";
import { StepProgress } from "./task_bar";
import { Paragraphs } from "./task_dialogs";
import { TaskPage } from "./task_page";
import { calmTimeText, isMaze, nextText, stepTitle, timeLeft } from "./task_state";
import "./step.css";

/** A participant's page: a maze, a form or a rest. */
export function StepPage({ map }: { map: ComponentChildren }) {
  const { store } = useConsole();
  const { task } = store.state.value;
  const language = task?.language || "en";
  useEffect(() => {
    document.documentElement.lang = language;
  }, [language]);
  return (
    <>
      {task === undefined && <Preparing />}
      {task !== undefined && (isMaze(task) ? <TaskPage map={map} /> : <CalmPage task={task} />)}
      {task?.paused && <PauseSheet />}
    </>
  );
}

/** Until the step is known: what is drawn earlier would move when its tags come. */
function Preparing() {
  return (
    <main class="step">
      <LinkBanner />
      <p class="quiet">Preparing…</p>
    </main>
  );
}

/** A page without a map. */
function CalmPage({ task }: { task: Task }) {
  const { store } = useConsole();
  const rests = task.kind === TaskKind.TASK_REST && task.phase === TaskPhase.PHASE_RUNNING;
  return (
    <div class={`step ${rests ? "rests" : ""}`}>
      <header class="step-head" data-area="task">
        <h1>{stepTitle(store.state.value)}</h1>
        <StepProgress task={task} />
      </header>
      <LinkBanner />
      <main class="step-body">
        {task.phase === TaskPhase.PHASE_FINISHED ? (
          <FinishedStep task={task} />
        ) : task.kind === TaskKind.TASK_REST ? (
          <Rest task={task} />
        ) : (
          <FormStep key={task.step} task={task} />
        )}
      </main>
    </div>
  );
}

/** A cross to look at. What is said below it changes once a minute: nothing moves. */
function Rest({ task }: { task: Task }) {
  const { store, actions } = useConsole();
  const left = timeLeft(task, store.now.value) ?? 0;
  if (task.phase === TaskPhase.PHASE_WAITING) {
    return (
      <section class="panel step-card" aria-label="Rest">
        <Paragraphs
          text={
            task.introduction ||
            "Please sit comfortably and look at the cross that comes next. There is nothing to do. It ends by itself."
          }
        />
        <p class="quiet">It takes {calmTimeText(left).replace(" left", "").toLowerCase()}.</p>
        <button
          type="button"
          class="main"
          disabled={!store.linked.value}
          onClick={() => void actions.begin()}
        >
          Begin
        </button>
      </section>
    );
  }
  return (
    <section class="rest" aria-label="Rest">
      <svg viewBox="-10 -10 20 20" role="img" aria-label="Look at this cross" data-area="cross">
        <path d="M-9 0H9M0-9V9" />
      </svg>
      <output class="quiet">{calmTimeText(left)}</output>
    </section>
  );
}

function FinishedStep({ task }: { task: Task }) {
  const { completionCode: code } = task;
  return (
    <section class="panel step-card" aria-label="Finished">
      {code === "" ? <output>{nextText(task)}</output> : <CompletionCode code={code} />}
    </section>
  );
}

/** What a participant who was invited elsewhere takes back there. */
function CompletionCode({ code }: { code: string }) {
  const { actions } = useConsole();
  const field = useRef<HTMLInputElement>(null);
  const copy = async () => {
    field.current?.select();
    try {
      await navigator.clipboard.writeText(code);
      actions.notify("Copied.");
    } catch {
      actions.notify("Press Ctrl+C to copy the code.");
    }
  };
  return (
    <>
      <p>Thank you! This is your completion code. Copy it before you close this page.</p>
      <div class="row">
        <input
          ref={field}
          class="completion-code"
          aria-label="Completion code"
          readOnly
          value={code}
        />
        <button type="button" class="main" onClick={() => void copy()}>
          Copy
        </button>
      </div>
    </>
  );
}

/** Covers the page while the experimenter has paused the step. */
function PauseSheet() {
  const dialog = useRef<HTMLDialogElement>(null);
  const heading = useId();
  useEffect(() => {
    const shown = dialog.current;
    if (!shown) return undefined;
    shown.showModal();
    const mounted = new AbortController();
    // Browsers close a dialog at the second Escape, whatever its page says.
    shown.addEventListener("close", () => shown.showModal(), { signal: mounted.signal });
    return () => {
      mounted.abort();
      shown.close();
    };
  }, []);
  return (
    <dialog
      ref={dialog}
      class="pause-sheet"
      tabIndex={-1}
      aria-labelledby={heading}
      onCancel={(event) => event.preventDefault()}
    >
      <h2 id={heading}>Paused</h2>
      <p>Please wait. Nothing is lost, and the time does not count.</p>
    </dialog>
  );
}
