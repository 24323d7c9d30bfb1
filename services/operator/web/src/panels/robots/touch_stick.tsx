import { ArrowDown, ArrowLeft, ArrowRight, ArrowUp } from "lucide-preact";
import { useConsole } from "../../app/console";
import { DriveAction } from "../../protocol/generated/console_pb";
import "./robots.css";

const keys = [
  { action: DriveAction.DRIVE_FORWARD, name: "forward", Icon: ArrowUp },
  { action: DriveAction.DRIVE_TURN_LEFT, name: "left", Icon: ArrowLeft },
  { action: DriveAction.DRIVE_TURN_RIGHT, name: "right", Icon: ArrowRight },
  { action: DriveAction.DRIVE_BACKWARD, name: "backward", Icon: ArrowDown },
] as const;

/** Drives while a finger rests on it, under the rules of the keys. Shown on touch screens. */
export function TouchStick() {
  const { teleoperation } = useConsole();
  return (
    <fieldset class="touch-stick" aria-label="Drive">
      {keys.map(({ action, name, Icon }) => {
        const end = () => teleoperation.release(action);
        return (
          <button
            key={name}
            type="button"
            class={name}
            aria-label={`Drive ${name}`}
            aria-pressed={teleoperation.action.value === action}
            onPointerDown={(event) => {
              event.preventDefault();
              event.currentTarget.setPointerCapture(event.pointerId);
              teleoperation.press(action);
            }}
            onPointerUp={end}
            onPointerCancel={end}
            onLostPointerCapture={end}
          >
            <Icon size={26} />
          </button>
        );
      })}
    </fieldset>
  );
}
