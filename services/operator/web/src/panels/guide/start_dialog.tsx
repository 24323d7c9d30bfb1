import { useComputed } from "@preact/signals";
import { useConsole } from "../../app/console";
import { Modal } from "../../app/modal";
import { count } from "../format";
import { MethodText } from "./method_text";
import { tourStateOf } from "./tour";
import "./guide.css";

/** All robots stand and nobody has control: how to begin. */
export function StartDialog() {
  const { store, actions, tour } = useConsole();
  const robots = store.robots.value;
  const heard = useComputed(() => store.state.value.robots.size).value;
  const guide = async () => {
    actions.closeDialog();
    const taken = await actions.takeControlNow(robots, "");
    if (taken.accepted) await actions.go(robots);
  };
  const watch = () => {
    actions.closeDialog();
    void actions.go(robots);
  };
  const showRound = () => {
    void guide();
    tour.begin(tourStateOf(store));
  };
  return (
    <Modal title={readyText(robots.length, heard)}>
      <p class="start-text">
        <StartText robots={robots.length} />
      </p>
      <ul class="start">
        <Choice
          text="Guide the robots yourself"
          detail="You get control of all of them."
          main
          act={() => void guide()}
        />
        <Choice
          text="Show me round"
          detail="The same, with a guide of two minutes."
          act={showRound}
        />
        <Choice text="Watch" detail="The robots go; whoever is there guides them." act={watch} />
      </ul>
    </Modal>
  );
}

/** `heard`: how many have told of themselves. */
function readyText(robots: number, heard: number): string {
  return heard < robots
    ? `${heard} of ${count(robots, "robot")} ready`
    : `${count(robots, "robot")} ready`;
}

function StartText({ robots }: { robots: number }) {
  const { method = "" } = useConsole().store.state.value.session ?? {};
  if (method === "" || method === "ig-mcts") {
    return (
      <>
        Your map is partly wrong. The robots see what is there, and send you pictures. Correct the
        map, and draw paths to the goals ⚑.
      </>
    );
  }
  return (
    <>
      Your map is partly wrong: correct it as you learn more.{" "}
      <MethodText method={method} many={robots > 1} /> The run is over when all goals ⚑ are reached.
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
