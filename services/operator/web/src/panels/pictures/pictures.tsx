import { useConsole } from "../../app/console";
import { keyHint } from "../../app/shortcuts";
import { cellText } from "../../protocol/cells";
import type { Snapshot } from "../../protocol/generated/console_pb";
import { ageOf } from "../../state/freshness";
import {
  commandBlockedReason,
  differenceOf,
  mayCommand,
  nameOf,
  unanswered,
  worldOf,
} from "../../state/selectors";
import { bytesText, count, duration } from "../format";
import { HistoryStrip } from "./history_strip";
import { LiveView } from "./live_view";
import { PictureImage } from "./picture_image";
import { answerText, cellsBytes, directionText, summaryOf } from "./summary";
import "./pictures.css";

/** Pictures of the chosen robot, and its live view if the method streams. */
export function Pictures() {
  const { store } = useConsole();
  const robot = store.chosenRobot.value;
  const picture = store.chosenPicture.value;
  const streams = store.state.value.session?.streams ?? false;
  return (
    <section class="panel pictures" aria-label="Pictures" data-tour="pictures">
      {streams && robot !== undefined && <LiveView robot={robot} />}
      {picture !== undefined && <PictureDetails picture={picture} />}
      {picture === undefined && !streams && <NoPicture robot={robot} />}
      {robot !== undefined && <HistoryStrip robot={robot} />}
    </section>
  );
}

function NoPicture({ robot }: { robot: string | undefined }) {
  return (
    <>
      <h2>Pictures{robot !== undefined && ` of ${robot}`}</h2>
      <p class="quiet">None yet. A robot sends a picture when it is worth your time.</p>
    </>
  );
}

/** Changes the map to what the picture shows, and says what the cells would have cost on the wire. */
function AcceptButton({ picture }: { picture: Snapshot }) {
  const { store } = useConsole();
  const state = store.state.value;
  const belief = state.beliefs.get(picture.world);
  const columns = worldOf(state, picture.robot)?.columns;
  if (belief === undefined || columns === undefined || !mayCommand(state)) return undefined;
  const { missing, wrong } = differenceOf(picture, belief, columns);
  const changes = [
    ...missing.map((cell) => ({ cell, wall: true })),
    ...wrong.map((cell) => ({ cell, wall: false })),
  ];
  if (changes.length === 0) return undefined;
  const cells = bytesText(cellsBytes(picture));
  const sent = picture.bytes > 0 ? `, the picture ${bytesText(picture.bytes)}` : "";
  return (
    <button
      type="button"
      disabled={!store.linked.value}
      title={`Its cells as numbers take ${cells}${sent}. Undo takes the change back.`}
      onClick={() => store.change(changes)}
    >
      Accept {count(changes.length, "cell")}
      <span class="quiet"> {cells}</span>
    </button>
  );
}

function PictureDetails({ picture }: { picture: Snapshot }) {
  const { store, actions } = useConsole();
  const state = store.state.value;
  const { robot, world, sequenceNumber, cell, heading } = picture;
  const columns = worldOf(state, robot)?.columns ?? 0;
  return (
    <>
      <div class="row">
        <h2>
          {robot}: picture {String(sequenceNumber)}
        </h2>
        <span class="quiet">{duration(ageOf(picture.receivedAt, store.now.value))} old</span>
        {unanswered(state, robot) === picture && mayCommand(state) ? (
          <button
            type="button"
            class="end main"
            disabled={!store.linked.value || commandBlockedReason(state, robot) !== undefined}
            onClick={() => actions.nothingNew()}
          >
            Nothing new here <kbd>{keyHint("nothing new")}</kbd>
          </button>
        ) : (
          <span class="end quiet">{answerText(picture, nameOf(state, picture.answeredBy))}</span>
        )}
      </div>
      <PictureImage picture={picture} />
      <div class="about">
        <p>
          {summaryOf(picture, state.beliefs.get(world), columns)}{" "}
          <span class="quiet">
            From {cellText(cell)}, facing {directionText(heading)}.
          </span>
        </p>
        <span class="acts">
          <button type="button" onClick={() => store.centre(cell)}>
            Show on the map
          </button>
          <AcceptButton picture={picture} />
        </span>
      </div>
    </>
  );
}
