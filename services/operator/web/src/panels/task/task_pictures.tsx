import { useConsole } from "../../app/console";
import { cellText } from "../../protocol/cells";
import { HistoryStrip } from "../pictures/history_strip";
import { PictureImage } from "../pictures/picture_image";
import { directionText } from "../pictures/summary";
import "../pictures/pictures.css";

/** The picture that the participant looks at, and those before. What it shows is for them to see. */
export function TaskPictures() {
  const { store } = useConsole();
  const robot = store.chosenRobot.value;
  const picture = store.chosenPicture.value;
  return (
    <section class="panel pictures" aria-label="Pictures">
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
            from {cellText(picture.cell)}, to the {directionText(picture.heading)}
          </p>
        </>
      )}
      {robot !== undefined && <HistoryStrip robot={robot} />}
    </section>
  );
}
