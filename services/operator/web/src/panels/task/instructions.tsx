import { useConsole } from "../../app/console";
import { MethodWords } from "../start/method_words";
import { isMappingTask } from "./task_state";

/** What the participant has to do: in the mapping task, or with the method of this part of the study. */
export function Instructions() {
  const state = useConsole().store.state.value;
  if (isMappingTask(state)) return <Mapping />;
  const method = state.session?.method ?? "";
  return (
    <ol class="instructions">
      <li>
        This is your map of a maze, and parts of it are wrong: walls are missing, and others are not
        there. Lead the robot to all its goals ⚑, and correct the map as you learn more: draw
        missing walls with <kbd>W</kbd>, erase wrong ones with <kbd>E</kbd>.
      </li>
      <li>
        <MethodWords method={method} many={false} />
      </li>
      <li>When the robot has reached all goals you may finish this part.</li>
    </ol>
  );
}

function Mapping() {
  return (
    <ol class="instructions">
      <li>
        This is your map of a maze, and parts of it are wrong: walls are missing, and others are not
        there.
      </li>
      <li>
        A robot drives through the real maze and sends you one picture at a time. The cone on the
        map shows where it stood and where its camera looked.
      </li>
      <li>
        Compare the picture with your map. Draw missing walls with <kbd>W</kbd>, erase wrong ones
        with <kbd>E</kbd>. Then ask for the next picture with <kbd>N</kbd>.
      </li>
      <li>When the robot has reached all its goals ⚑ you may finish the maze, or go on.</li>
    </ol>
  );
}
