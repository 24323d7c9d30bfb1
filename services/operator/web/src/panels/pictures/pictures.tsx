import { Crosshair, Download, Maximize2, Video } from "lucide-preact";
import { useEffect, useRef } from "preact/hooks";
import { useConsole } from "../../app/console";
import { keyHint } from "../../app/shortcuts";
import { cellText } from "../../protocol/cells";
import type { Snapshot } from "../../protocol/generated/console_pb";
import {
  commandBlockedReason,
  differenceOf,
  mayCommand,
  nameOf,
  unanswered,
  worldOf,
} from "../../state/selectors";
import { camerasShown } from "../../state/store";
import { bytesText, count, duration } from "../format";
import { isTask } from "../task/task_state";
import { HistoryStrip } from "./history_strip";
import { LiveView } from "./live_view";
import { PictureImage, usePixels } from "./picture_image";
import { answerText, cellsBytes, directionText, pictureAge, summaryOf } from "./summary";
import "./pictures.css";

/** Pictures of the chosen robot, and the cameras that are open; those of methods that stream are. */
export function Pictures() {
  const { store } = useConsole();
  const robot = store.chosenRobot.value;
  const picture = store.chosenPicture.value;
  const cameras = store.state.value.isPast ? [] : camerasShown(store);
  const panel = useRef<HTMLElement>(null);
  // Keys answer the picture: it has to be in sight.
  useEffect(() => panel.current?.scrollTo({ top: 0 }), [picture, store.selections.value]);
  return (
    <section
      ref={panel}
      class="panel pictures"
      aria-label="Pictures"
      data-tour="pictures"
      data-area="picture"
    >
      {picture !== undefined && <PictureDetails picture={picture} />}
      {picture === undefined && cameras.length === 0 && <NoPicture robot={robot} />}
      {cameras.length > 0 && (
        <div class="cameras">
          {cameras.map((name) => (
            <LiveView key={name} robot={name} />
          ))}
        </div>
      )}
      {robot !== undefined && <HistoryStrip robot={robot} />}
    </section>
  );
}

/** Opens and closes a robot's camera. Participants see what their part of the study offers. */
function CameraButton({ robot }: { robot: string }) {
  const { store, commands } = useConsole();
  const { session } = store.state.value;
  if (session?.streams || isTask(store.state.value)) return undefined;
  return (
    <button
      type="button"
      aria-pressed={store.cameras.value.includes(robot)}
      title={`Live view of ${robot} (${keyHint("camera")}). Its bytes count apart from the pictures'.`}
      onClick={commands.camera}
    >
      <Video size={14} /> Camera
    </button>
  );
}

function NoPicture({ robot }: { robot: string | undefined }) {
  return (
    <>
      <div class="row">
        <h2>Pictures{robot !== undefined && ` of ${robot}`}</h2>
        {robot !== undefined && <CameraButton robot={robot} />}
      </div>
      <p class="quiet">None yet. A robot sends a picture when it is worth your time.</p>
    </>
  );
}

/** Enlarges the picture, saves it as a file. */
function PictureButtons({ picture }: { picture: Snapshot }) {
  const { store } = useConsole();
  const pixels = usePixels(picture);
  const { robot, sequenceNumber } = picture;
  if (pixels.kind !== "ready") return undefined;
  return (
    <>
      <button
        type="button"
        onClick={() => {
          store.large.value = { kind: "picture", robot };
        }}
      >
        <Maximize2 size={14} /> Enlarge
      </button>
      <a class="button" href={pixels.url} download={`${robot}-picture-${sequenceNumber}.jpg`}>
        <Download size={14} /> Save
      </a>
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
      title={`Answers the picture. Its cells as numbers take ${cells}${sent}. Undo takes the change back.`}
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
        <span class="quiet">{duration(pictureAge(state, picture, store.now.value))} old</span>
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
      <div class="about">
        <p>
          {summaryOf(picture, state.beliefs.get(world), columns)}{" "}
          <span class="quiet">
            From {cellText(cell)}, facing {directionText(heading)}.
          </span>
        </p>
        <AcceptButton picture={picture} />
      </div>
      <PictureImage picture={picture} />
      <div class="row acts">
        <CameraButton robot={robot} />
        <button type="button" title="Show on the map" onClick={() => store.centre(cell)}>
          <Crosshair size={14} /> Find
        </button>
        <PictureButtons picture={picture} />
      </div>
    </>
  );
}
