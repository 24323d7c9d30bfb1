import { fittedGrid } from "./fitted_grid.mjs";
import { ReceivedMessages } from "./received.mjs";
import { texts } from "./texts.mjs";
import { patience, until } from "./wait.mjs";

/** Expected messages in the browser's console while the service is away. */
export const connectionTrouble = /WebSocket|ERR_CONNECTION|Failed to load resource/;

/** The console in one browser: what a person sees and does there, and the messages that it received. */
export class ConsolePage {
  /** Errors that the browser reported: scripts, policies, missing files. */
  faults = [];

  /** @param {import("playwright-core").Page} page */
  constructor(page) {
    this.page = page;
    this.received = new ReceivedMessages(page);
    page.setDefaultTimeout(1000 * patience);
    page.on("pageerror", (error) => this.faults.push(String(error)));
    page.on("console", (message) => {
      if (message.type() === "error") this.faults.push(message.text());
    });
  }

  /** Waits until the page shows robots and a map, and the link is live. */
  async isReady() {
    await this.page.locator(".fleet-card").first().waitFor();
    await this.link("live");
    await this.map.waitFor();
    await until("the operator's map comes", () => this.received.all("belief").length > 0);
  }

  /** Waits until the page shows this state of its link. */
  link(state) {
    return this.page.locator(".latency").getByText(state).first().waitFor();
  }

  dialog(title) {
    return this.page.getByRole("dialog", { name: title });
  }

  button(name) {
    return this.page.getByRole("button", { name });
  }

  /** A robot's card in the fleet strip. */
  card(robot) {
    return this.page
      .locator(".fleet-card")
      .filter({ has: this.page.getByText(robot, { exact: true }) });
  }

  panel(name) {
    return this.page.getByRole("region", { name });
  }

  /** Makes a choice in the start dialog. */
  async begin(choice = texts.guide) {
    await this.button(choice).click();
    await this.dialog(texts.ready).waitFor({ state: "hidden" });
  }

  /** Waits until the page shows a text. */
  reads(text) {
    return this.page.getByText(text).first().waitFor();
  }

  /** Waits until the text is nowhere: the page draws a message some time after it came. */
  readsNoLonger(text) {
    return until(`${text} is gone`, async () => (await this.page.getByText(text).count()) === 0);
  }

  async chooses(robot) {
    await this.card(robot).locator(".choose").click();
    await this.isChosen(robot);
  }

  /** Opens the robot's camera and waits for its first frame. */
  async opensCamera(robot) {
    await this.chooses(robot);
    await this.press("i");
    const camera = this.page.locator(".live-view").filter({ hasText: robot });
    await camera.getByText(texts.isLive).waitFor();
  }

  /** Shows the page as it was at this share of its time line. */
  async looksBack(share) {
    const slider = this.page.getByRole("slider", { name: texts.position });
    const { x, y, width, height } = await slider.boundingBox();
    await this.page.mouse.click(x + share * width, y + height / 2);
    await this.reads(texts.ago);
  }

  /** Waits until the robot is chosen. */
  isChosen(robot) {
    return this.card(robot).locator(".choose[aria-pressed=true]").waitFor();
  }

  press(key) {
    return this.page.keyboard.press(key);
  }

  /** The newest cell of a robot that the page received. */
  cellOf(robot) {
    const { row, column } = this.received.robot(robot).cell;
    return `${row},${column}`;
  }

  /** Waits until the robot has entered another cell. */
  async moves(robot) {
    const moves = () => this.received.robot(robot)?.cellMoves ?? 0n;
    const before = moves();
    await until(`${robot} moves on`, () => moves() > before);
  }

  /** Waits until the robot has stood still for a moment. After a stop it first ends its current action. */
  async comesToRest(robot) {
    const looks = () => {
      const { cell, heading, lowLevelSteps } = this.received.robot(robot);
      return `row ${cell.row}, column ${cell.column}, heading ${heading}, ${lowLevelSteps} steps`;
    };
    let before = "";
    await until(
      `${robot} stands`,
      () => {
        const rests = before === looks();
        before = looks();
        return rests;
      },
      { every: 0.8, now: looks },
    );
  }

  // --- the map ---

  /** The map's canvas. */
  get map() {
    return this.page.getByRole("application", { name: texts.yourMap });
  }

  /** The button of a map tool. */
  tool(name) {
    return this.page.getByRole("group", { name: texts.mapTools }).getByRole("button", { name });
  }

  /** Moves the pointer to a cell and waits until the status line names it. */
  async pointAt({ row, column }) {
    await this.press("0"); // shows all of it
    const { x, y } = await this.#centreOf({ row, column });
    await this.page.mouse.move(x, y);
    await this.page.getByText(texts.cell({ row, column })).first().waitFor();
    return { x, y };
  }

  /** The status line's text about a cell. */
  async wordsAbout(cell) {
    await this.pointAt(cell);
    return (await this.page.locator(".map-status span").first().textContent()) ?? "";
  }

  /** Draws or erases one wall with the mouse and waits until the service has confirmed it. */
  async edits(cell, tool = texts.wall) {
    const { revision } = this.received.belief();
    await this.draws([cell], tool);
    await until("the edit is confirmed", () => this.received.belief().revision > revision);
  }

  /** Waits for the map of that revision, and returns it. */
  async waitsForRevision(revision) {
    const now = () => this.received.belief().revision;
    await until(`map revision ${revision}`, () => now() >= revision, { now });
    return this.received.belief();
  }

  /** Toggles a wall and waits until the service has confirmed it. */
  toggles(cell) {
    return this.edits(cell, this.received.isWall(cell) ? texts.erase : texts.wall);
  }

  /** Drags a path from where the robot is drawn through the middles of cells, and sends it where the page asks. */
  async drawsPath(robot, cells) {
    await this.tool(texts.path).click();
    await this.press("0"); // shows all of it
    const bar = this.page.locator(".map-path-facts");
    await until(`a path begins at ${robot}`, async () => {
      const { x, y } = await this.#placeOf(robot);
      await this.page.mouse.move(x, y);
      await this.page.mouse.down();
      await this.pointAt(cells[0]);
      if (texts.drawing(robot).test((await bar.textContent()) ?? "")) return true;
      await this.page.mouse.up();
      return false;
    });
    for (const cell of cells.slice(1)) await this.pointAt(cell);
    await this.page.mouse.up();
    if (await this.page.getByText(texts.waitsForYes).first().isVisible()) await this.press("Enter");
  }

  /** Chooses a tool and draws with the mouse through the middles of cells. */
  async draws(cells, tool) {
    await this.beginsDrawing(cells, tool);
    await this.page.mouse.up();
  }

  /** The same, but the mouse button stays down: the edit is sent when it is released. */
  async beginsDrawing([first, ...others], tool) {
    await this.tool(tool).click();
    await this.pointAt(first);
    await this.page.mouse.down();
    for (const cell of others) await this.pointAt(cell);
  }

  /** Screen position of a robot while the whole map is shown. */
  async #placeOf(robot) {
    const { rows, columns, cellSize, middleX, middleY } = this.received.newest("world", "w1");
    const { x, y } = this.received.robot(robot);
    const row = rows / 2 - (y - middleY) / cellSize - 0.5;
    return this.#centreOf({ row, column: columns / 2 + (x - middleX) / cellSize - 0.5 });
  }

  /** Screen position of a cell while the whole map is shown. */
  async #centreOf({ row, column }) {
    const { rows, columns } = this.received.newest("world", "w1");
    const box = await this.map.boundingBox();
    const { left, top, scale } = fittedGrid(box, { rows, columns });
    return { x: box.x + left + (column + 0.5) * scale, y: box.y + top + (row + 0.5) * scale };
  }
}
