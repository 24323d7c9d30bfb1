// Keys of the cell cursor. They work while the canvas has the focus.
import { clampCell, sameCell } from "./grid";
import { hasPathDraft } from "./keyboard_input";
import type { MapModel } from "./map_model";
import type { Cell } from "./map_props";
import type { ToolDriver } from "./tool_driver";
import { cellAt, panBy } from "./view";

const arrows: ReadonlyMap<string, Cell> = new Map([
  ["ArrowUp", { row: -1, column: 0 }],
  ["ArrowDown", { row: 1, column: 0 }],
  ["ArrowLeft", { row: 0, column: -1 }],
  ["ArrowRight", { row: 0, column: 1 }],
]);

export function isArrow(key: string): boolean {
  return arrows.has(key);
}

/** Space: pans while held during a drag, uses the tool when only pressed. */
export interface PanKey {
  held: boolean;
  used: boolean;
}

export class CursorKeys {
  readonly #model: MapModel;
  readonly #driver: ToolDriver;
  readonly #panKey: PanKey;

  constructor(model: MapModel, driver: ToolDriver, panKey: PanKey) {
    this.#model = model;
    this.#driver = driver;
    this.#panKey = panKey;
  }

  /** Returns whether the key was handled. */
  press(event: KeyboardEvent): boolean {
    const by = arrows.get(event.key);
    if (by && event.shiftKey) this.#pan(by);
    else if (by)
      this.#moveTo((cell) => ({ row: cell.row + by.row, column: cell.column + by.column }));
    else if (event.key === "Home") this.#moveTo((cell) => homeOf(cell, event.ctrlKey));
    else if (event.key === "End") this.#moveTo((cell) => this.#endOf(cell, event.ctrlKey));
    else if (event.key === " ") this.#holdPanKey();
    else if (event.key === "Enter") this.#enter(event.shiftKey);
    else if (event.key === "Delete" || event.key === "Backspace") this.#remove();
    else return false;
    return true;
  }

  release(event: KeyboardEvent): void {
    if (event.key !== " " || !this.#panKey.held) return;
    this.#panKey.held = false;
    if (!this.#panKey.used) this.#apply(event.shiftKey);
  }

  #holdPanKey(): void {
    if (this.#panKey.held) return; // key repeat
    this.#panKey.held = true;
    this.#panKey.used = false;
  }

  leave(): void {
    this.#panKey.held = false;
    this.#model.byKeyboard.value = false;
  }

  #pan(by: Cell): void {
    const view = this.#model.view.peek();
    if (view) this.#model.lookAt(panBy(view, -60 * by.column, -60 * by.row));
  }

  /** The first key only shows the cursor. */
  #moveTo(target: (cell: Cell) => Cell): void {
    const { world } = this.#model.props.peek();
    const cursor = this.#model.cursor.peek();
    const shown = this.#model.byKeyboard.peek() && cursor !== undefined;
    const from = cursor ?? this.#startCell();
    this.#model.moveCursor(clampCell(world, shown ? target(from) : from));
  }

  /** The chosen robot's cell, or the middle of the visible part. */
  #startCell(): Cell {
    const { robots, chosenRobot } = this.#model.props.peek();
    const robot = robots.find((one) => one.robot.name === chosenRobot)?.robot.cell;
    const view = this.#model.view.peek();
    if (robot || !view) return robot ?? { row: 0, column: 0 };
    return cellAt(view, { x: view.width / 2, y: view.height / 2 });
  }

  #endOf(cell: Cell, all: boolean): Cell {
    const { rows, columns } = this.#model.props.peek().world;
    return { row: all ? rows - 1 : cell.row, column: columns - 1 };
  }

  #enter(shift: boolean): void {
    if (this.#model.props.peek().tool === "path" && hasPathDraft(this.#model)) this.#driver.send();
    else this.#apply(shift);
  }

  #apply(shift: boolean): void {
    const cursor = this.#model.cursor.peek();
    if (!cursor || !this.#model.byKeyboard.peek()) {
      this.#moveTo((cell) => cell);
      return;
    }
    if (this.#model.props.peek().tool === "look") this.#chooseRobotIn(cursor);
    else this.#driver.apply(cursor, { erase: shift });
  }

  #chooseRobotIn(cell: Cell): void {
    const { robots, onChooseRobot } = this.#model.props.peek();
    const here = robots.find(({ robot }) => sameCell(robot.cell, cell));
    if (here) onChooseRobot(here.robot.name);
  }

  #remove(): void {
    if (this.#model.props.peek().tool !== "path") return;
    const cursor = this.#model.cursor.peek();
    const session = this.#model.paths.peek().get(this.#model.props.peek().chosenRobot ?? "");
    const onPath = session?.cells.some((cell) => sameCell(cell, cursor));
    this.#driver.removeVertex(onPath ? cursor : undefined);
  }
}

function homeOf(cell: Cell, all: boolean): Cell {
  return { row: all ? 0 : cell.row, column: 0 };
}
