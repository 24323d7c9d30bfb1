import { useComputed, useSignal } from "@preact/signals";
import {
  ChevronLeft,
  ChevronRight,
  Link,
  MessageSquarePlus,
  Pause,
  Play,
  Video,
} from "lucide-preact";
import { useConsole } from "../../app/console";
import { keyHint } from "../../app/shortcuts";
import { type Mark, MarkKind, Mode, type Playback } from "../../protocol/generated/console_pb";
import { playTime } from "../format";
import { ClipRecorder } from "./clip";
import { liveMarks } from "./live_marks";
import { linkTo } from "./moment_link";
import { markFrom, markNames, speeds, useReplay } from "./playback";
import "./replay.css";

/** The time line: of a recording, or of a run that this page watches. */
export function TimeBar() {
  const { store } = useConsole();
  const playback = store.state.value.playback;
  const mode = useComputed(() => store.live.value.welcome?.mode).value;
  if (playback !== undefined) return <ReplayBar playback={playback} />;
  // It keeps its place until the service tells the position, after a reconnection too.
  if (mode === Mode.REPLAY) return <section class="panel time-bar" aria-label="Recording" />;
  return mode === Mode.SUPERVISE ? <LiveBar /> : undefined;
}

function ReplayBar({ playback }: { playback: Playback }) {
  const { actions } = useConsole();
  const { toggle, speed, setSpeed } = useReplay();
  const { position, duration, marks, began } = playback;
  const seek = (to: number) => actions.seek({ position: to });
  return (
    <section class="panel time-bar" aria-label="Recording">
      <button type="button" class="main" onClick={toggle}>
        {playback.speed > 0 ? <Pause size={14} /> : <Play size={14} />}
        {playback.speed > 0 ? "Pause" : "Play"}
      </button>
      <Track from={0} to={duration} at={position} marks={marks} seek={seek} />
      <span class="times">
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
      <Jumps marks={marks} at={position} seek={seek} />
      <CopyLink time={began + position} />
      <Clip />
    </section>
  );
}

/** Looks back on what this page has shown. */
function LiveBar() {
  const { store, actions, commands } = useConsole();
  const { history, moment } = store;
  const { from, to } = history.span.value;
  const events = useComputed(() => store.live.value.events).value;
  const pictures = useComputed(() => store.live.value.pictures).value;
  const alerts = useComputed(() => store.live.value.alerts).value;
  const marks = useComputed(() =>
    liveMarks({ events, pictures, alerts }, history.goals.value).filter(
      ({ position }) => position >= history.span.value.from,
    ),
  ).value;
  const past = moment.value !== undefined;
  const at = moment.value?.time ?? to;
  const seek = (time: number) => actions.lookBack(time >= to - 0.5 ? undefined : time);
  return (
    <section class={`panel time-bar ${past ? "past" : ""}`} aria-label="Time line">
      <button
        type="button"
        class={past ? "main" : ""}
        aria-pressed={!past}
        title="Show the present"
        onClick={() => actions.lookBack(undefined)}
      >
        Live
      </button>
      <Track from={from} to={to} at={at} marks={marks} seek={seek} />
      <span class="times">{past ? `${playTime(to - at)} ago` : "now"}</span>
      <Jumps marks={marks} at={at} seek={seek} />
      <button
        type="button"
        title={`Write a note about this moment (${keyHint("note")})`}
        disabled={!store.linked.value}
        onClick={commands.note}
      >
        <MessageSquarePlus size={14} /> Note
      </button>
      <CopyLink time={at} />
      <Clip />
    </section>
  );
}

interface TrackProps {
  readonly from: number;
  readonly to: number;
  readonly at: number;
  readonly marks: readonly Mark[];
  seek(to: number): void;
}

/** Follows the time, except while it is dragged. */
function Track({ from, to, at, marks, seek }: TrackProps) {
  const dragged = useSignal<number | undefined>(undefined);
  const shown = dragged.value ?? at;
  const letGo = () => {
    dragged.value = undefined;
  };
  return (
    <div class="track">
      <input
        type="range"
        aria-label="Position"
        aria-valuetext={`${playTime(shown - from)} of ${playTime(to - from)}`}
        min={from}
        max={to}
        step="any"
        value={shown}
        onInput={({ currentTarget: { valueAsNumber: time } }) => {
          dragged.value = time;
          seek(time);
        }}
        onChange={letGo}
        onPointerCancel={letGo}
        onBlur={letGo}
      />
      <Ticks from={from} to={to} marks={marks} />
    </div>
  );
}

/** Top and bottom of a tick: kinds differ by height, too, not by colour alone. */
const tickHeights: Readonly<Record<MarkKind, readonly [number, number]>> = {
  [MarkKind.MARK_NONE]: [8, 10],
  [MarkKind.MARK_SNAPSHOT]: [7, 10],
  [MarkKind.MARK_EDIT]: [4, 10],
  [MarkKind.MARK_GUIDANCE]: [4, 7],
  [MarkKind.MARK_GOAL]: [0, 4],
  [MarkKind.MARK_ALERT]: [0, 10],
  [MarkKind.MARK_NOTE]: [1, 10],
};

function Ticks({ from, to, marks }: Pick<TrackProps, "from" | "to" | "marks">) {
  if (to <= from) return undefined;
  return (
    <svg class="ticks" viewBox="0 0 1000 10" preserveAspectRatio="none" aria-hidden="true">
      {marks.map(({ kind, position }, i) => {
        const x = (1000 * (position - from)) / (to - from);
        const [y1, y2] = tickHeights[kind];
        return <line key={i} x1={x} x2={x} y1={y1} y2={y2} class={`of-${nameOfKind(kind)}`} />;
      })}
    </svg>
  );
}

function nameOfKind(kind: MarkKind): string {
  return markNames.find(([other]) => other === kind)?.[1] ?? "";
}

/** To the mark before and after, of each kind. */
function Jumps({ marks, at, seek }: Pick<TrackProps, "marks" | "at" | "seek">) {
  return (
    <span class="jumps">
      {markNames.map(([kind, name]) => {
        const before = markFrom(marks, at, -1, kind);
        const after = markFrom(marks, at, 1, kind);
        return (
          <span key={name} class={`jump of-${name}`}>
            <button
              type="button"
              disabled={before === undefined}
              aria-label={`Previous ${name}`}
              title={before?.text}
              onClick={() => before && seek(before.position)}
            >
              <ChevronLeft size={12} />
            </button>
            {name}
            <button
              type="button"
              disabled={after === undefined}
              aria-label={`Next ${name}`}
              title={after?.text}
              onClick={() => after && seek(after.position)}
            >
              <ChevronRight size={12} />
            </button>
          </span>
        );
      })}
    </span>
  );
}

/** Copies an address that opens this moment: in this page, or in the replay of the run. */
function CopyLink({ time }: { time: number }) {
  const { store, actions } = useConsole();
  const copy = async () => {
    const link = linkTo(location.href, store.live.value.session?.name ?? "", time);
    try {
      await navigator.clipboard.writeText(link);
      actions.notify("Copied a link to this moment.");
    } catch {
      actions.notify(`Link to this moment: ${link}`);
    }
  };
  return (
    <button type="button" title="Copy a link to this moment" onClick={() => void copy()}>
      <Link size={14} /> <span class="word">Copy link</span>
    </button>
  );
}

/** Records the map as a film, until it is pressed again. */
function Clip() {
  const { store, actions } = useConsole();
  const recorder = useSignal<ClipRecorder | undefined>(undefined);
  const press = async () => {
    const running = recorder.value;
    recorder.value = undefined;
    if (running !== undefined) {
      await running.save(`conav-${store.live.value.session?.name || "clip"}.webm`);
      return;
    }
    const canvas = document.querySelector<HTMLCanvasElement>("canvas.map-surface");
    const begun = canvas && ClipRecorder.begin(canvas);
    if (begun) recorder.value = begun;
    else actions.notify("This browser cannot record the map.", "problem");
  };
  const on = recorder.value !== undefined;
  return (
    <button
      type="button"
      aria-pressed={on}
      title={on ? "Stop, and save the film of the map" : "Record the map as a film"}
      onClick={() => void press()}
    >
      <Video size={14} /> <span class="word">{on ? "Save" : "Clip"}</span>
    </button>
  );
}
