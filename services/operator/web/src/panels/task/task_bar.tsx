import { useState } from "preact/hooks";
import { useConsole } from "../../app/console";
import { type Task, TaskPhase } from "../../protocol/generated/console_pb";
import { reasonText } from "../attention/queue_texts";
import { BeginButton } from "./task_dialogs";
import {
  calmTimeText,
  goalsText,
  isMappingTask,
  isStudy,
  offersPaths,
  partName,
  type RobotNow,
  resultText,
  robotNow,
  stepTitle,
  timeLeft,
} from "./task_state";

/** The current maze, the participant's progress, and the buttons for the next action. */
export function TaskBar() {
  const { store } = useConsole();
  const state = store.state.value;
  const { task } = state;
  const part = partName(state);
  if (task === undefined) return <p class="quiet">Preparing…</p>;
  const { participant, phase, paused } = task;
  return (
    <section class="panel task-bar" aria-label="Task" data-area="task">
      <h1>{stepTitle(state)}</h1>
      {task.title !== "" && <StepProgress task={task} />}
      {phase === TaskPhase.PHASE_WAITING && <BeginButton />}
      {phase === TaskPhase.PHASE_RUNNING && <Running task={task} />}
      {phase === TaskPhase.PHASE_FINISHED && (
        <output class="task-result">{resultText(task, part)}</output>
      )}
      {paused && <strong>Paused</strong>}
      <span class="end quiet">Participant {participant}</span>
    </section>
  );
}

function Running({ task }: { task: Task }) {
  const { store } = useConsole();
  const live = store.linked.value;
  const state = store.state.value;
  const now = robotNow(state, store.chosenRobot.value);
  const left = timeLeft(task, store.now.value);
  return (
    <>
      {now === "stopped" && <ResumeButton live={live} />}
      {now !== "stopped" && isMappingTask(state) && <NextButton now={now} live={live} />}
      {now === "waiting for you" && isStudy(state) && <NothingNewButton live={live} />}
      {task.mayFinish && <FinishButton live={live} part={partName(state).toLowerCase()} />}
      {isStudy(state) && offersPaths(state) && <CurrentRequest />}
      {task.feedback && <span>{goalsText(task)}</span>}
      {task.feedback && left !== undefined && <span class="quiet">{calmTimeText(left)}</span>}
    </>
  );
}

/** How much of the study is done, without saying what is to come. */
export function StepProgress({ task }: { task: Task }) {
  const text = `Step ${task.number} of ${task.count}`;
  const done = task.phase === TaskPhase.PHASE_FINISHED ? task.number : task.number - 1;
  return (
    <span class="step-progress quiet">
      <progress aria-label={text} value={done} max={task.count} /> {text}
    </span>
  );
}

function ResumeButton({ live }: { live: boolean }) {
  const { store, actions } = useConsole();
  const go = () => void actions.resume(store.robots.value);
  return (
    <button type="button" class="main" disabled={!live} onClick={go}>
      Resume the robot <kbd>G</kbd>
    </button>
  );
}

function NextButton({ now, live }: { now: RobotNow; live: boolean }) {
  const { actions } = useConsole();
  const drives = now === "driving";
  return (
    <button
      type="button"
      class="main"
      disabled={!live || drives}
      onClick={() => actions.nothingNew()}
    >
      {drives ? "The robot is on its way…" : "Next picture"} {!drives && <kbd>N</kbd>}
    </button>
  );
}

function NothingNewButton({ live }: { live: boolean }) {
  const { actions } = useConsole();
  return (
    <button type="button" class="main" disabled={!live} onClick={() => actions.nothingNew()}>
      Nothing new in this picture <kbd>X</kbd>
    </button>
  );
}

/** What the robot needs now. */
function CurrentRequest() {
  const { store } = useConsole();
  const { attention, session } = store.state.value;
  const item = attention?.items[0];
  return item === undefined ? undefined : (
    <strong>
      {item.robot} {reasonText(item.reason, session?.drives ?? false)}
    </strong>
  );
}

/** Asks for confirmation, because the map cannot be changed afterwards. */
function FinishButton({ live, part }: { live: boolean; part: string }) {
  const { actions } = useConsole();
  const [asked, setAsked] = useState(false);
  if (!asked) {
    return (
      <button type="button" disabled={!live} onClick={() => setAsked(true)}>
        Finish this {part}
      </button>
    );
  }
  return (
    <span class="row">
      Finish? You cannot change your map afterwards.
      <button type="button" class="main" disabled={!live} onClick={() => void actions.finish()}>
        Yes, finish
      </button>
      <button type="button" onClick={() => setAsked(false)}>
        No, continue
      </button>
    </span>
  );
}
