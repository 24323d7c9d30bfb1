// Applies the tools to cells, for both the pointer and the keyboard.

import { cancelStroke, mayChange, paint } from "./edit_session";
import { toggleGoal } from "./goals";
import { cellText, clampCell, lineCells, rectangleCells, sameCell } from "./grid";
import type { MapModel } from "./map_model";
import type { Cell, Tool } from "./map_props";
import * as paths from "./path/path_session";

/** `erase`: Shift is held, so that drawing tools erase. */
type Modifiers = { readonly erase: boolean };

type Stroke =
  | { kind: "brush"; last: Cell; wall: boolean }
  /** `before`: the draft when the stroke began. */
  | { kind: "path"; robot: string; last: Cell; moved: boolean; before: paths.PathSession };

export class ToolDriver {
  #model: MapModel;
  /** The rectangle belongs to the model, because another tool or world ends it. */
  #stroke: Stroke | undefined;
  /** Whether the last press, and the one before, hit a vertex. */
  #onVertex = false;
  #onVertexBefore = false;

  constructor(model: MapModel) {
    this.#model = model;
  }

  get busy(): boolean {
    return this.#stroke !== undefined || this.#model.rectangle.peek() !== undefined;
  }

  /** `robot`: name of the robot under the pointer. */
  press(cell: Cell, modifiers: Modifiers, robot?: string): void {
    const { tool } = this.#model.props.peek();
    if (tool === "path") this.#pressPath(cell, robot);
    else if (tool === "goal") void toggleGoal(this.#model, cell);
    else if (tool !== "look" && this.#model.mayEdit()) this.#pressEdit(cell, modifiers, tool);
  }

  #pressEdit(cell: Cell, modifiers: Modifiers, tool: Tool): void {
    const wall = tool !== "erase" && !modifiers.erase;
    if (tool === "rectangle") {
      this.#model.rectangle.value = { from: cell, to: cell, wall };
      return;
    }
    this.#noteIfFixed(cell);
    this.#stroke = { kind: "brush", last: cell, wall };
    this.#model.change((session) => paint(session, [cell], wall));
  }

  drag(to: Cell): void {
    const stroke = this.#stroke;
    const model = this.#model;
    const rectangle = model.rectangle.peek();
    if (rectangle) {
      model.rectangle.value = { ...rectangle, to: clampCell(model.props.peek().world, to) };
    } else if (stroke?.kind === "brush") {
      model.change((session) => paint(session, lineCells(stroke.last, to), stroke.wall));
      stroke.last = to;
    } else if (stroke?.kind === "path" && !sameCell(stroke.last, to)) {
      stroke.last = to;
      stroke.moved = true;
      model.changePath(stroke.robot, (session) =>
        session.bend
          ? paths.bendTo(session, model.routes, to)
          : paths.drawTo(session, model.routes, clampCell(model.props.peek().world, to)),
      );
    }
  }

  release(): void {
    const stroke = this.#stroke;
    this.#stroke = undefined;
    this.#endRectangle();
    if (stroke?.kind === "brush") this.#model.endStroke();
    if (stroke?.kind === "path") this.#endPath(stroke);
  }

  /** Restores the state before the press. */
  cancel(): void {
    const stroke = this.#stroke;
    this.#stroke = undefined;
    this.#model.rectangle.value = undefined;
    if (stroke?.kind === "brush") this.#model.change(cancelStroke);
    if (stroke?.kind === "path") {
      this.#model.changePath(stroke.robot, (session) =>
        paths.revert(session, stroke.before, this.#model.routes),
      );
    }
  }

  /** Removes the path's vertex in the cell. */
  doublePress(cell: Cell): void {
    const { tool } = this.#model.props.peek();
    if (tool === "path" && this.#onVertexBefore) this.removeVertex(cell);
  }

  /** Enter and Space: like a press, but a rectangle needs two, one per corner, and a path gets the route to the cell. */
  apply(cell: Cell, modifiers: Modifiers): void {
    if (this.#model.props.peek().tool === "path") {
      this.#addRoute(cell);
      return;
    }
    if (this.#model.rectangle.peek()) {
      this.drag(cell);
      this.release();
      return;
    }
    this.press(cell, modifiers);
    if (this.#model.props.peek().tool !== "rectangle") this.release();
  }

  #noteIfFixed(cell: Cell): void {
    if (mayChange(this.#model.props.peek().world, cell)) return;
    this.#model.showNote(`${cellText(cell)} is on the border and cannot be edited.`);
  }

  #endRectangle(): void {
    const rectangle = this.#model.rectangle.peek();
    this.#model.rectangle.value = undefined;
    if (!rectangle) return;
    const cells = rectangleCells(rectangle.from, rectangle.to);
    this.#model.change((session) => paint(session, cells, rectangle.wall));
    this.#model.endStroke();
  }

  // --- Paths ---

  /** A path begins at a robot or at the end of a path, and is bent at its cells. A press elsewhere draws nothing. */
  #pressPath(cell: Cell, pressed: string | undefined): void {
    const model = this.#model;
    const robot = pressed ?? this.#robotOfPath(cell);
    this.#onVertexBefore = this.#onVertex;
    this.#onVertex = false;
    if (robot === undefined) {
      model.showNote("Start at a robot, or at the end of its path.");
      return;
    }
    const { chosenRobot, onChooseRobot } = model.props.peek();
    if (robot !== chosenRobot) onChooseRobot(robot);
    else if (!model.mayGuide()) return;
    const before = model.paths.peek().get(robot);
    if (!before) return;
    this.#stroke = { kind: "path", robot, last: cell, moved: false, before };
    model.changePath(robot, (session) => {
      if (pressed !== undefined) return paths.beginDrawing(session);
      const taken = this.#adopted(session);
      this.#onVertex = isVertex(taken, cell);
      const isEnd = sameCell(cell, taken.cells.at(-1));
      return isEnd ? paths.continueDrawing(taken) : paths.grab(taken, cell);
    });
  }

  /** The robot whose path is in the cell: the chosen one, or else the only one whose path ends there. */
  #robotOfPath(cell: Cell): string | undefined {
    const { chosenRobot } = this.#model.props.peek();
    const chosen = this.#model.paths.peek().get(chosenRobot ?? "");
    if (chosen && paths.canGrab(this.#adopted(chosen), cell)) return chosenRobot;
    const ending = [...this.#model.paths.peek().values()].filter((session) =>
      sameCell(cell, paths.endOf(session, this.#given(session.robot))),
    );
    return ending.length === 1 ? ending[0]?.robot : undefined;
  }

  #given(robot: string): readonly Cell[] {
    return this.#model.ahead.peek().get(robot) ?? [];
  }

  /** Without a draft the robot's current path is one. */
  #adopted(session: paths.PathSession): paths.PathSession {
    if (paths.hasDraft(session)) return session;
    return paths.adopt(session, this.#model.routes, this.#given(session.robot));
  }

  /** What was drawn is sent at release, unless it is known to be blocked or the robot has left it. */
  #endPath(stroke: { robot: string; moved: boolean }): void {
    const model = this.#model;
    model.changePath(stroke.robot, (session) => {
      if (session.bend) return paths.endBend(session);
      const ended = paths.endDrawing(session);
      if (!stroke.moved || !model.sendAtRelease.peek() || !paths.hasDraft(ended)) return ended;
      if (model.assess(ended.cells).blocked) return paths.ask(ended);
      return paths.isDrawnByHand(ended) ? paths.send(ended) : ended;
    });
  }

  /** Removes a vertex of the chosen robot's draft: the one in `cell`, or the end. */
  removeVertex(cell?: Cell): void {
    this.#ofChosen((session) => paths.removeVertex(session, this.#model.routes, cell));
  }

  /** A path that is known to be blocked needs a second yes. */
  send(): void {
    if (!this.#model.mayGuide()) return;
    this.#ofChosen((session) => {
      const blocked = !session.asked && this.#model.assess(session.cells).blocked !== undefined;
      return blocked ? paths.ask(session) : paths.send(session);
    });
  }

  #addRoute(cell: Cell): void {
    const { chosenRobot } = this.#model.props.peek();
    if (chosenRobot === undefined) this.#model.showNote("Choose a robot first.");
    else if (this.#model.mayGuide())
      this.#ofChosen((session) => paths.addRoute(session, this.#model.routes, cell));
  }

  /** Withdraws the chosen robot's path, or drops its draft if it has no path. */
  clear(): void {
    const { guidance, chosenRobot } = this.#model.props.peek();
    const has = (guidance.get(chosenRobot ?? "")?.path.length ?? 0) > 0;
    if (!has) this.leave();
    else if (this.#model.mayGuide()) this.#ofChosen(paths.withdraw);
  }

  leave(): void {
    this.#ofChosen(paths.leave);
  }

  #ofChosen(change: (session: paths.PathSession) => paths.PathSession): void {
    const { chosenRobot } = this.#model.props.peek();
    if (chosenRobot !== undefined) this.#model.changePath(chosenRobot, change);
  }
}

function isVertex(session: paths.PathSession, cell: Cell): boolean {
  return paths.vertices(session.cells).some((index) => sameCell(session.cells[index], cell));
}
