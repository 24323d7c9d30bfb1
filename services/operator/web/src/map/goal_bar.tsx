import { canUndoGoals, clearGoals, goalsOfChosen, undoGoals } from "./goals";
import type { MapModel } from "./map_model";

/** For the goal tool: how many the chosen robot has, and buttons to take back or clear them. */
export function GoalBar({ model }: { model: MapModel }) {
  const { mayGuide, robots } = model.props.value;
  const chosen = goalsOfChosen(model);
  if (!chosen) return <p class="map-card">Choose a robot whose goals are set here.</p>;
  const reached = robots.find(({ robot }) => robot.name === chosen.robot)?.robot.goalsReached ?? [];
  const title = mayGuide.allowed ? "" : `Not now: ${mayGuide.reason}`;
  return (
    <div class="map-card goals">
      <output>
        <strong>{chosen.robot}</strong>: {counted(chosen.left.length)} left, {reached.length}{" "}
        reached. Click the map to set a goal, click a goal to remove it.
      </output>
      <button
        type="button"
        disabled={!mayGuide.allowed || !canUndoGoals(model)}
        title={title || "Undo (Ctrl+Z)"}
        onClick={() => void undoGoals(model)}
      >
        Undo
      </button>
      <button
        type="button"
        disabled={!mayGuide.allowed || chosen.left.length === 0}
        title={title || "Removes all goals that are left"}
        onClick={() => void clearGoals(model)}
      >
        Clear goals
      </button>
    </div>
  );
}

function counted(goals: number): string {
  return `${goals} ${goals === 1 ? "goal" : "goals"}`;
}
