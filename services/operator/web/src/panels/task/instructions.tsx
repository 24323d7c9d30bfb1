/** What the participant of a mapping task has to do. */
export function Instructions() {
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
