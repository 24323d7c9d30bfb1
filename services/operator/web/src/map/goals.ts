// Goals of robots that do not keep them themselves: set and removed one by one, with an undo of this page's own changes.
import { type Cell, contains, sameCell } from "./grid";
import type { MapModel } from "./map_model";

export type GoalChange = {
  readonly robot: string;
  readonly add: readonly Cell[];
  readonly remove: readonly Cell[];
};

/** The chosen robot's goals, unless it is not known or its goals are not set here. */
export function goalsOfChosen(model: MapModel): { robot: string; left: Cell[] } | undefined {
  const { robots, chosenRobot, offersGoals } = model.props.value;
  const one = robots.find(({ robot }) => robot.name === chosenRobot)?.robot;
  return one && offersGoals ? { robot: one.name, left: one.goalsLeft } : undefined;
}

/** Sets a goal in the cell, or removes the one that is there. */
export async function toggleGoal(model: MapModel, cell: Cell): Promise<void> {
  const chosen = goalsOfChosen(model);
  if (!chosen || !contains(model.props.peek().world, cell) || !model.mayGuide()) return;
  const has = chosen.left.some((goal) => sameCell(goal, cell));
  await change(model, {
    robot: chosen.robot,
    add: has ? [] : [cell],
    remove: has ? [cell] : [],
  });
}

export async function clearGoals(model: MapModel): Promise<void> {
  const chosen = goalsOfChosen(model);
  if (!chosen || chosen.left.length === 0 || !model.mayGuide()) return;
  await change(model, { robot: chosen.robot, add: [], remove: chosen.left });
}

export function canUndoGoals(model: MapModel): boolean {
  const robot = goalsOfChosen(model)?.robot;
  return model.goalChanges.value.some((one) => one.robot === robot);
}

/** Takes back this page's newest change of the chosen robot's goals. A goal that was reached since stays reached. */
export async function undoGoals(model: MapModel): Promise<void> {
  const robot = goalsOfChosen(model)?.robot;
  const last = model.goalChanges.peek().findLast((one) => one.robot === robot);
  if (last === undefined || !model.mayGuide()) return;
  const { onGoals } = model.props.peek();
  model.goalChanges.value = model.goalChanges.peek().filter((one) => one !== last);
  await onGoals(last.robot, last.remove, last.add);
}

async function change(model: MapModel, asked: GoalChange): Promise<void> {
  const { onGoals } = model.props.peek();
  const { accepted } = await onGoals(asked.robot, asked.add, asked.remove);
  if (accepted) model.goalChanges.value = [...model.goalChanges.peek(), asked];
}
