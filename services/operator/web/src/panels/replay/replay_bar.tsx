import { useSignal } from "@preact/signals";
import { useConsole } from "../../app/console";
import { MarkKind, type Playback } from "../../protocol/generated/console_pb";
import { playTime } from "../format";
import { markFrom, markNames, speeds, useReplay } from "./playback";
import "./replay.css";

/** Position in a recording, with play, speed and jumps. */
export function ReplayBar() {
  const { store } = useConsole();
  const playback = store.state.value.playback;
  const { toggle, speed, setSpeed } = useReplay();
  if (playback === undefined) return undefined;
  const { position, duration } = playback;
  return (
    <section class="panel replay" aria-label="Recording">
      <button type="button" class="main" onClick={toggle}>
        {playback.speed > 0 ? "❚❚ Pause" : "▶ Play"}
      </button>
      <div class="track">
        <Slider playback={playback} />
        <Ticks playback={playback} />
      </div>
      <span>
        {playTime(position)} / {playTime(duration)}
      </span>
      <label>
        <span class="unseen">Speed</span>
        <select value={speed} onChange={(event) => setSpeed(Number(event.currentTarget.value))}>
          {speeds.map((each) => (
            <option key={each} value={each}>
              {each}×
            </option>
          ))}
        </select>
      </label>
      {markNames.map(([kind, name]) => (
        <Jumps key={name} kind={kind} name={name} playback={playback} />
      ))}
    </section>
  );
}

/** Follows the recording, except while it is dragged. */
function Slider({ playback: { position, duration } }: { playback: Playback }) {
  const { actions } = useConsole();
  const dragged = useSignal<number | undefined>(undefined);
  const shown = dragged.value ?? position;
  const letGo = () => {
    dragged.value = undefined;
  };
  return (
    <input
      type="range"
      aria-label="Position"
      aria-valuetext={`${playTime(shown)} of ${playTime(duration)}`}
      min={0}
      max={duration}
      step="any"
      value={shown}
      onInput={({ currentTarget: { valueAsNumber: to } }) => {
        dragged.value = to;
        actions.seek({ position: to });
      }}
      onChange={letGo}
      onPointerCancel={letGo}
      onBlur={letGo}
    />
  );
}

interface JumpProps {
  kind: MarkKind;
  name: string;
  playback: Playback;
}

function Jumps({ kind, name, playback: { marks, position } }: JumpProps) {
  const { actions } = useConsole();
  const before = markFrom(marks, position, -1, kind);
  const after = markFrom(marks, position, 1, kind);
  if (!marks.some((mark) => mark.kind === kind)) return undefined;
  return (
    <span class="jumps">
      <button
        type="button"
        disabled={before === undefined}
        aria-label={`Previous ${name}`}
        onClick={() => before && actions.seek({ position: before.position })}
      >
        ◀
      </button>
      {name}
      <button
        type="button"
        disabled={after === undefined}
        aria-label={`Next ${name}`}
        onClick={() => after && actions.seek({ position: after.position })}
      >
        ▶
      </button>
    </span>
  );
}

function Ticks({ playback: { marks, duration } }: { playback: Playback }) {
  if (duration <= 0) return undefined;
  return (
    <svg class="ticks" viewBox="0 0 1000 10" preserveAspectRatio="none" aria-hidden="true">
      {marks.map(({ kind, position }, i) => {
        const x = (1000 * position) / duration;
        const isAlert = kind === MarkKind.MARK_ALERT;
        // Alerts differ by height too, not by colour alone.
        return (
          <line key={i} x1={x} x2={x} y1={isAlert ? 0 : 4} y2={10} class={isAlert ? "alert" : ""} />
        );
      })}
    </svg>
  );
}
