import { Play, Square } from "lucide-preact";
import { useConsole } from "../../app/console";
import { keyHint } from "../../app/shortcuts";
import { askedByMe, holderOf, isStopped, mayCommand, mayStop } from "../../state/selectors";
import { duration } from "../format";
import "./robots.css";

/** Stop, resume, and who has control. Everybody can always stop. */
export function ControlBar() {
  const { store } = useConsole();
  const state = store.state.value;
  const robot = store.chosenRobot.value;
  return (
    <section class="control" aria-label="Control">
      {mayStop(state) && <ForAll />}
      {robot !== undefined && mayCommand(state) && <ControlOf robot={robot} />}
    </section>
  );
}

function ForAll() {
  const { store, actions } = useConsole();
  const state = store.state.value;
  const robots = store.robots.value;
  const anyStopped = robots.some((name) => isStopped(state, name));
  return (
    <>
      <button type="button" class="danger" onClick={() => void actions.stop([])}>
        <Square size={14} fill="currentColor" /> Stop all <kbd>{keyHint("stop all")}</kbd>
      </button>
      <button
        type="button"
        disabled={!store.canCommand.value || !anyStopped}
        onClick={() => void actions.resume([...robots])}
      >
        <Play size={14} /> Resume all <kbd>{keyHint("resume all")}</kbd>
      </button>
    </>
  );
}

function ControlOf({ robot }: { robot: string }) {
  const { store, actions } = useConsole();
  const holder = holderOf(store.state.value, robot);
  const asked = askedByMe(store.state.value).includes(robot);
  if (holder.kind === "me") {
    const left = holder.until - (store.now.value ?? holder.until);
    return (
      <button
        type="button"
        disabled={!store.canCommand.value}
        onClick={() => void actions.releaseControl([robot])}
        title="Renewed while you use this page"
      >
        You control {robot} ({duration(Math.max(0, left))}): release
      </button>
    );
  }
  return (
    <button
      type="button"
      disabled={!store.canCommand.value}
      onClick={() => actions.takeControl([robot])}
    >
      {holder.kind === "other"
        ? `${holder.name} controls ${robot}: ${asked ? "asked" : "take over"}`
        : `Take control of ${robot}`}
    </button>
  );
}
