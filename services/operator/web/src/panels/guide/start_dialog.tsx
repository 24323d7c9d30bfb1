import { useComputed } from "@preact/signals";
import { useState } from "preact/hooks";
import { useConsole } from "../../app/console";
import { Modal } from "../../app/modal";
import { NameField } from "../../app/name_field";
import { count } from "../format";
import { MethodText } from "./method_text";
import { tourStateOf } from "./tour";
import "./guide.css";

/** How to start: all robots are stopped and nobody has control. */
export function StartDialog() {
  const { store, actions, tour, rename } = useConsole();
  const robots = store.robots.value;
  const reported = useComputed(() => store.state.value.robots.size).value;
  const [name, setName] = useState("");
  const begin = async (act: () => Promise<unknown>) => {
    actions.closeDialog();
    if (name.trim() !== "") await rename(name);
    await act();
  };
  const guide = () => void begin(() => actions.start(robots));
  const watch = () => void begin(() => actions.resume(robots));
  const takeTour = () => {
    guide();
    tour.begin(tourStateOf(store));
  };
  return (
    <Modal title={readyText(robots.length, reported)}>
      <p class="start-text">
        <StartText robots={robots.length} />
      </p>
      <ul class="start">
        <Choice
          text="Guide the robots yourself"
          detail="You take control of all robots."
          main
          act={guide}
        />
        <Choice
          text="Take the tour"
          detail="Guide the robots, with help for the first two minutes."
          act={takeTour}
        />
        <Choice text="Watch" detail="The robots start. You only watch." act={watch} />
      </ul>
      <NameField name={name} onName={setName} />
    </Modal>
  );
}

/** `reported`: number of robots that have sent their state. */
function readyText(robots: number, reported: number): string {
  return reported < robots
    ? `${reported} of ${count(robots, "robot")} ready`
    : `${count(robots, "robot")} ready`;
}

function StartText({ robots }: { robots: number }) {
  const { method = "" } = useConsole().store.state.value.session ?? {};
  if (method === "" || method === "ig-mcts") {
    return (
      <>
        Your map is partly wrong. The robots see what is there and send you pictures. Correct the
        map and draw paths to the goals ⚑.
      </>
    );
  }
  return (
    <>
      Your map is partly wrong. Correct it as you learn more.{" "}
      <MethodText method={method} many={robots > 1} /> The run ends when all goals ⚑ are reached.
    </>
  );
}

interface ChoiceProps {
  text: string;
  detail: string;
  main?: boolean;
  act: () => void;
}

function Choice({ text, detail, main, act }: ChoiceProps) {
  return (
    <li>
      <button type="button" class={main ? "main" : ""} onClick={act}>
        <strong>{text}</strong>
        <span>{detail}</span>
      </button>
    </li>
  );
}
