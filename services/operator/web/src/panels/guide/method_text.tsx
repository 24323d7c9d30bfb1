/** How robots and a person work together by `method`, for the start and for a study. `many`: more robots than one. */
export function MethodText({ method, many }: { method: string; many: boolean }) {
  const robot = many ? "Each robot" : "The robot";
  switch (method) {
    case "ig-mcts":
      return (
        <>
          {robot} drives by itself. Draw a path that you would take with <kbd>P</kbd>; it takes that
          into account. When it sends you a picture it waits: correct the map, draw a new path, or
          press <kbd>X</kbd> if nothing is new.
        </>
      );
    case "instruction":
      return (
        <>
          {robot} follows the path that you draw with <kbd>P</kbd>. It stops where the path ends or
          a wall is in the way, until you draw another one. You see what its camera sees.
        </>
      );
    case "teleop":
      return (
        <>
          You drive {many ? "the chosen robot" : "the robot"}: hold the arrow keys. You see what its
          camera sees. It stands when you let go.
        </>
      );
    case "greedy":
      return <>{robot} goes by itself to its nearest goal, and heeds no path.</>;
    default:
      return <>{robot} waits for you.</>;
  }
}
