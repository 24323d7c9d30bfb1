import type { ComponentChildren } from "preact";
import { useEffect } from "preact/hooks";
import { useConsole } from "../../app/console";
import { LinkBanner, UndeliveredStop } from "../../app/link_banner";
import { cellText } from "../../protocol/cells";
import { pictureOf } from "../../state/selectors";
import { Queue } from "../attention/queue";
import { HistoryStrip } from "../pictures/history_strip";
import { LiveView } from "../pictures/live_view";
import { PictureImage } from "../pictures/picture_image";
import { directionText } from "../pictures/summary";
import { DriveBadge } from "../robots/drive_badge";
import { FleetStrip } from "../robots/fleet_strip";
import { TaskBar } from "./task_bar";
import { hasLiveView, hasSeveralRobots, isBetweenMazes } from "./task_state";
import "./task.css";
import "../pictures/pictures.css";

/** A participant's page: task, map, and pictures or a live view. */
export function TaskPage({ map }: { map: ComponentChildren }) {
  const { commands, store } = useConsole();
  const several = hasSeveralRobots(store.state.value);
  const over = isBetweenMazes(store.state.value);
  return (
    <div class="console task">
      <header class="top">
        <TaskBar />
        {several && <FleetStrip />}
      </header>
      <LinkBanner />
      <UndeliveredStop />
      <main class="stage">
        <div class="map" data-area="map">
          {map}
        </div>
      </main>
      <aside class="side" aria-label="Pictures and help">
        {several && <Queue />}
        {!over && <DriveBadge />}
        <TaskViews />
        <button type="button" onClick={() => commands.help()}>
          Instructions and keys <kbd>?</kbd>
        </button>
      </aside>
    </div>
  );
}

/** The live view of the chosen robot where the method has one, else its pictures. */
export function TaskViews() {
  const { store } = useConsole();
  const robot = store.chosenRobot.value;
  useNewestPicture();
  if (robot === undefined || !hasLiveView(store.state.value)) return <TaskPictures />;
  return (
    <section class="panel" aria-label="Camera" data-area="picture" data-robot={robot}>
      <LiveView robot={robot} />
    </section>
  );
}

/** Shows each new picture, even if an older one was chosen. */
function useNewestPicture(): void {
  const { store } = useConsole();
  const newest = pictureOf(store.state.value, store.chosenRobot.value)?.sequenceNumber;
  useEffect(() => {
    store.chosenSequence.value = undefined;
  }, [newest, store]);
}

/** The chosen picture and the earlier ones. Its summary is left out: finding the differences is the task. */
function TaskPictures() {
  const { store } = useConsole();
  const robot = store.chosenRobot.value;
  const picture = store.chosenPicture.value;
  return (
    <section class="panel pictures" aria-label="Pictures" data-area="picture" data-robot={robot}>
      {picture === undefined ? (
        <>
          <h2>Pictures</h2>
          <p class="quiet">None yet.</p>
        </>
      ) : (
        <>
          <h2>Picture {String(picture.sequenceNumber)}</h2>
          <PictureImage picture={picture} />
          <p class="quiet">
            From {cellText(picture.cell)}, facing {directionText(picture.heading)}.
          </p>
        </>
      )}
      {robot !== undefined && <HistoryStrip robot={robot} />}
    </section>
  );
}
