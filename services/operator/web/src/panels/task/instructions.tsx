import type { ComponentChildren } from "preact";
import { useConsole } from "../../app/console";
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
      <li>{methods.get(method) ?? "The robot waits for you."}</li>
      <li>When the robot has reached all goals you may finish this part.</li>
    </ol>
  );
}

const methods: ReadonlyMap<string, ComponentChildren> = new Map<string, ComponentChildren>([
  [
    "ig-mcts",
    <>
      The robot drives by itself. Draw a path that you would take with <kbd>P</kbd>; it takes that
      into account. When it sends you a picture it waits: correct the map, draw a new path, or press{" "}
      <kbd>X</kbd> if nothing is new.
    </>,
  ],
  [
    "instruction",
    <>
      The robot follows the path that you draw with <kbd>P</kbd>. It stops where the path ends or a
      wall is in the way, until you draw another one. You see what its camera sees.
    </>,
  ],
  [
    "teleop",
    <>
      You drive the robot: hold the arrow keys. You see what its camera sees. It stands when you let
      go.
    </>,
  ],
]);

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
