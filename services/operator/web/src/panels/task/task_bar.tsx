import { useState } from "preact/hooks";
import { useConsole } from "../../app/console";
import { type Task, TaskPhase } from "../../protocol/generated/console_pb";
import { BeginButton } from "./begin_dialog";
import { goalsText, type RobotNow, resultText, robotNow } from "./task_state";

/** Which maze it is, how far the participant has come, and what they can do now. */
export function TaskBar() {
  const { store } = useConsole();
  const { task } = store.state.value;
  if (task === undefined) return <p class="quiet">The maze is being prepared…</p>;
  const { participant, number, count, phase } = task;
  return (
    <section class="panel task-bar" aria-label="Task">
      <h1>
        Maze {number} of {count}
      </h1>
      {phase === TaskPhase.PHASE_WAITING && <BeginButton />}
      {phase === TaskPhase.PHASE_RUNNING && <Running task={task} />}
      {phase === TaskPhase.PHASE_FINISHED && (
        <output class="task-result">{resultText(task)}</output>
      )}
      <span class="end quiet">Participant {participant}</span>
    </section>
  );
}

function Running({ task }: { task: Task }) {
  const { store } = useConsole();
  const live = store.link.value.state === "live";
  const now = robotNow(store.state.value, store.chosenRobot.value);
  return (
    <>
      <MainButton now={now} live={live} />
      {task.mayFinish && <FinishButton live={live} />}
      <span>{goalsText(task)}</span>
    </>
  );
}

function MainButton({ now, live }: { now: RobotNow; live: boolean }) {
  const { store, actions } = useConsole();
  if (now === "stopped") {
    return (
      <button
        type="button"
        class="main"
        disabled={!live}
        onClick={() => void actions.go(store.robots.value)}
      >
        Let the robot go on <kbd>G</kbd>
      </button>
    );
  }
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

/** Asks once more: the map cannot be changed afterwards. */
function FinishButton({ live }: { live: boolean }) {
  const { actions } = useConsole();
  const [asked, setAsked] = useState(false);
  if (!asked) {
    return (
      <button type="button" disabled={!live} onClick={() => setAsked(true)}>
        Finish this maze
      </button>
    );
  }
  return (
    <span class="row">
      Finish? Your map stays as it is then.
      <button type="button" class="main" disabled={!live} onClick={() => void actions.finish()}>
        Yes, finish
      </button>
      <button type="button" onClick={() => setAsked(false)}>
        No, go on
      </button>
    </span>
  );
}
