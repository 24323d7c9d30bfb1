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
          ? paths.bendTo(session, model.grid, to)
          : paths.drawTo(session, model.grid, clampCell(model.grid.size, to)),
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
        paths.revert(session, stroke.before, this.#model.grid),
      );
    }
  }

  /** Removes an existing vertex; anywhere else ends the path and sends it. */
  doublePress(cell: Cell): void {
    const { tool } = this.#model.props.peek();
    if (tool !== "path") return;
    if (this.#onVertexBefore) this.removeVertex(cell);
    else this.send();
  }

  /** Enter and Space: like a press, but a rectangle needs two, one per corner. */
  apply(cell: Cell, modifiers: Modifiers): void {
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

  #pressPath(cell: Cell, pressed: string | undefined): void {
    const model = this.#model;
    const robot = this.#chooseFor(pressed);
    if (robot === undefined) {
      model.showNote("Choose a robot first: click it.");
      return;
    }
    if (robot === model.props.peek().chosenRobot && !model.mayGuide()) return;
    const before = model.paths.peek().get(robot);
    if (!before) return;
    this.#stroke = { kind: "path", robot, last: cell, moved: false, before };
    model.changePath(robot, (session) => {
      const held = paths.canGrab(session, cell) ? session : this.#adopted(session, cell);
      this.#onVertexBefore = this.#onVertex;
      this.#onVertex = isVertex(held, cell);
      return paths.canGrab(held, cell)
        ? paths.grab(held, cell)
        : paths.beginDrawing(session, model.grid, cell);
    });
  }

  /** The robot to draw for: the pressed one, unless the chosen one has a draft to continue. */
  #chooseFor(pressed: string | undefined): string | undefined {
    const { chosenRobot, robots, onChooseRobot } = this.#model.props.peek();
    const draft = this.#model.paths.peek().get(chosenRobot ?? "");
    if (draft && paths.hasDraft(draft)) return chosenRobot;
    const only = robots.length === 1 ? robots[0]?.robot.name : undefined;
    const robot = pressed ?? chosenRobot ?? only;
    if (robot !== undefined && robot !== chosenRobot) onChooseRobot(robot);
    return robot;
  }

  /** Makes the robot's current path the draft if the press hit it. */
  #adopted(session: paths.PathSession, cell: Cell): paths.PathSession {
    const path = this.#model.props.peek().guidance.get(session.robot)?.path ?? [];
    if (paths.hasDraft(session) || sameCell(cell, session.start)) return session;
    if (!path.some((other) => sameCell(other, cell))) return session;
    const adopted = paths.adopt(session, this.#model.grid, path);
    return paths.canGrab(adopted, cell) ? adopted : session;
  }

  #endPath(stroke: { robot: string; moved: boolean }): void {
    this.#model.changePath(stroke.robot, (session) => {
      const ended = session.bend ? paths.endBend(session) : paths.endDrawing(session);
      const sends = stroke.moved && this.#model.sendAtRelease.peek();
      return sends ? paths.send(ended) : ended;
    });
  }

  /** Removes a vertex of the chosen robot's draft: the one in `cell`, or the end. */
  removeVertex(cell?: Cell): void {
    this.#ofChosen((session) => paths.removeVertex(session, this.#model.grid, cell));
  }

  send(): void {
    if (this.#model.mayGuide()) this.#ofChosen(paths.send);
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
