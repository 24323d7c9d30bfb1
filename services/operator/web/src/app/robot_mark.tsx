import { cornersOf } from "../map/draw/shapes";
import { useConsole } from "./console";
import { lookOf } from "./palette";

const radius = 9.5;

/** A robot's shape, colour and letter. Callers write its name next to it. */
export function RobotMark({ robot }: { robot: string }) {
  const { letter, colour, shape } = lookOf(
    Math.max(0, useConsole().store.robots.value.indexOf(robot)),
  );
  const corners = cornersOf(shape);
  const points = corners.map(({ x, y }) => `${12 + radius * x},${12 + radius * y}`).join(" ");
  return (
    <svg class="robot-mark" viewBox="0 0 24 24" aria-hidden="true">
      {corners.length > 0 ? (
        <polygon points={points} fill={colour} />
      ) : (
        <circle cx="12" cy="12" r={radius} fill={colour} />
      )}
      <text x="12" y="16">
        {letter}
      </text>
    </svg>
  );
}
