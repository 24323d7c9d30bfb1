import { X } from "lucide-preact";
import { useEffect } from "preact/hooks";
import { useConsole } from "../../app/console";
import { keyHint } from "../../app/shortcuts";
import { LiveView } from "./live_view";
import { PictureImage } from "./picture_image";
import "./pictures.css";

/** A camera or the chosen picture over the map, until it is closed. Keys go on to drive. */
export function LargeView() {
  const { store, commands } = useConsole();
  const large = store.large.value;
  const picture = store.chosenPicture.value;
  const open = large !== undefined && (large.kind === "camera" || picture !== undefined);
  useEffect(() => {
    if (!open) return undefined;
    // Before the map, for which Escape means something else.
    const close = (event: KeyboardEvent) => {
      if (event.key !== "Escape" || event.shiftKey || store.dialog.value !== undefined) return;
      event.preventDefault();
      event.stopPropagation();
      commands["close view"]();
    };
    document.addEventListener("keydown", close, { capture: true });
    return () => document.removeEventListener("keydown", close, { capture: true });
  }, [open, store, commands]);
  if (!open) return undefined;
  const title =
    large.kind === "camera"
      ? `Camera of ${large.robot}`
      : `${picture?.robot}: picture ${picture?.sequenceNumber}`;
  return (
    <section class="large-view panel" aria-label="Large view">
      <div class="row">
        <h2>{title}</h2>
        <button type="button" class="end" onClick={commands["close view"]}>
          <X size={14} /> Close <kbd>{keyHint("close view")}</kbd>
        </button>
      </div>
      {large.kind === "camera" ? (
        <LiveView robot={large.robot} large />
      ) : (
        picture && <PictureImage picture={picture} />
      )}
    </section>
  );
}
