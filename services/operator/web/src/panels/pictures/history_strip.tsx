import { ChevronLeft, ChevronRight } from "lucide-preact";
import { useConsole } from "../../app/console";
import { keyHint } from "../../app/shortcuts";
import { type Snapshot, SnapshotAnswer } from "../../protocol/generated/console_pb";
import { nameOf } from "../../state/selectors";
import { usePixels } from "./picture_image";
import { answerText } from "./summary";

const mostShown = 12;

/** The newest pictures of a robot, oldest first. */
export function HistoryStrip({ robot }: { robot: string }) {
  const { store, actions } = useConsole();
  const all = store.state.value.pictures.get(robot) ?? [];
  const chosen = store.chosenPicture.value?.sequenceNumber;
  const at = all.findIndex(({ sequenceNumber }) => sequenceNumber === chosen);
  if (all.length < 2) return undefined;
  const first = windowStart(all.length, at, mostShown);
  const shown = all.slice(first, first + mostShown);
  return (
    <div class="history">
      <button
        type="button"
        disabled={at <= 0}
        onClick={() => actions.stepPicture(-1)}
        aria-label="Older picture"
        title={keyHint("older picture")}
      >
        <ChevronLeft size={14} />
      </button>
      <ol>
        {shown.map((picture) => (
          <Thumbnail key={String(picture.sequenceNumber)} picture={picture} />
        ))}
      </ol>
      <button
        type="button"
        disabled={at >= all.length - 1}
        onClick={() => actions.stepPicture(1)}
        aria-label="Newer picture"
        title={keyHint("newer picture")}
      >
        <ChevronRight size={14} />
      </button>
    </div>
  );
}

function Thumbnail({ picture }: { picture: Snapshot }) {
  const { store } = useConsole();
  const { sequenceNumber, answer, bytes } = picture;
  const who = nameOf(store.state.value, picture.answeredBy);
  const sign = answer === SnapshotAnswer.ANSWER_NONE ? "!" : "✓";
  return (
    <li>
      <button
        type="button"
        aria-pressed={store.chosenPicture.value === picture}
        aria-label={`Picture ${sequenceNumber}, ${answerText(picture, who)}`}
        onClick={() => {
          store.chosenSequence.value = sequenceNumber;
          store.centre(picture.cell);
        }}
      >
        {bytes > 0 && <SmallImage picture={picture} />}
        <span>
          {String(sequenceNumber)} {sign}
        </span>
      </button>
    </li>
  );
}

function SmallImage({ picture }: { picture: Snapshot }) {
  const state = usePixels(picture);
  return state.kind === "ready" ? <img src={state.url} alt="" /> : undefined;
}

/** Index of the first of `size` entries to show out of `length`, with entry `at` near the middle; the newest if `at` is negative. */
export function windowStart(length: number, at: number, size: number): number {
  const newest = Math.max(0, length - size);
  return at < 0 ? newest : Math.max(0, Math.min(newest, at - Math.floor(size / 2)));
}
