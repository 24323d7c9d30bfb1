/** How to work with robots that use `method`. `many`: there are several robots. */
export function MethodText({ method, many }: { method: string; many: boolean }) {
  const robot = many ? "Each robot" : "The robot";
  switch (method) {
    case "ig-mcts":
      return (
        <>
          {robot} drives by itself. Draw the path that you would take with <kbd>P</kbd>; the robot
          takes it into account. When it sends a picture, it waits: correct the map, draw a new
          path, or press <kbd>X</kbd> if nothing is new.
        </>
      );
    case "instruction":
      return (
        <>
          {robot} follows the path that you draw with <kbd>P</kbd>. Where the path ends or a wall
          blocks it, it stops until you draw another one. You see what its camera sees.
        </>
      );
    case "teleop":
      return (
        <>
          You drive {many ? "the chosen robot" : "the robot"}: hold the arrow keys. You see what its
          camera sees. It stops when you release the key.
        </>
      );
    case "greedy":
      return <>{robot} drives to its nearest goal by itself and ignores paths.</>;
    default:
      return <>{robot} waits for you.</>;
  }
}
