import { fittedGrid } from "./fitted_grid.mjs";
import { Told } from "./told.mjs";
import { patience, until } from "./wait.mjs";

/** What may be written to the browser's console while the service is away. */
export const connectionTrouble = /WebSocket|ERR_CONNECTION|Failed to load resource/;

/** The console in one browser: what a person sees and does there, and what the service told it. */
export class ConsolePage {
  /** Faults that the browser complained of: scripts, policies, missing files. */
  faults = [];

  /** @param {import("playwright-core").Page} page */
  constructor(page) {
    this.page = page;
    this.told = new Told(page);
    page.setDefaultTimeout(1000 * patience);
    page.on("pageerror", (error) => this.faults.push(String(error)));
    page.on("console", (message) => {
      if (message.type() === "error") this.faults.push(message.text());
    });
  }

  /** The page shows robots and a map, and the link is live. */
  async isReady() {
    await this.page.locator(".fleet-card").first().waitFor();
    await this.link("live");
    await this.map.waitFor();
    await until("the operator's map comes", () => this.told.all("belief").length > 0);
  }

  /** Waits until the page says so of its link to the service. */
  link(state) {
    return this.page.locator(".latency").getByText(state).first().waitFor();
  }

  dialog(title) {
    return this.page.getByRole("dialog", { name: title });
  }

  button(name) {
    return this.page.getByRole("button", { name });
  }

  /** In the fleet strip. */
  card(robot) {
    return this.page
      .locator(".fleet-card")
      .filter({ has: this.page.getByText(robot, { exact: true }) });
  }

  panel(name) {
    return this.page.getByRole("region", { name });
  }

  /** Begins by the start dialog: "Guide the robots yourself" or another of its choices. */
  async begin(choice = /Guide the robots yourself/) {
    await this.button(choice).click();
    await this.dialog(/ready/).waitFor({ state: "hidden" });
  }

  /** Waits until a text can be read somewhere on the page. */
  reads(text) {
    return this.page.getByText(text).first().waitFor();
  }

  async chooses(robot) {
    await this.card(robot).locator(".choose").click();
    await this.isChosen(robot);
  }

  /** Waits until it is. */
  isChosen(robot) {
    return this.card(robot).locator(".choose[aria-pressed=true]").waitFor();
  }

  press(key) {
    return this.page.keyboard.press(key);
  }

  /** The cell of a robot, as the page was told: changes as it moves. */
  cellOf(robot) {
    const { row, column } = this.told.robot(robot).cell;
    return `${row},${column}`;
  }

  /** Waits until the robot has entered another cell. */
  async moves(robot) {
    const moves = () => this.told.robot(robot)?.cellMoves ?? 0n;
    const before = moves();
    await until(`${robot} moves on`, () => moves() > before);
  }

  /** Waits until the robot has stood for a moment: what it was about when it was stopped it ends first. */
  async comesToRest(robot) {
    const looks = () => {
      const { cell, heading, lowLevelSteps } = this.told.robot(robot);
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

  /** Its canvas. */
  get map() {
    return this.page.getByRole("application", { name: /^Your map/ });
  }

  /** The button of a tool of the map. */
  tool(name) {
    return this.page.getByRole("group", { name: "Map tools" }).getByRole("button", { name });
  }

  /** Puts the pointer on a cell, without leaving the map; the status line confirms that it is this one. */
  async pointAt({ row, column }) {
    await this.press("0"); // shows all of it
    const { x, y } = await this.#centreOf({ row, column });
    await this.page.mouse.move(x, y);
    await this.page.getByText(`Row ${row}, column ${column}:`).first().waitFor();
    return { x, y };
  }

  /** The status line's words about a cell. */
  async wordsAbout(cell) {
    await this.pointAt(cell);
    return (await this.page.locator(".map-status span").first().textContent()) ?? "";
  }

  /** Draws (or erases) one wall with the mouse, and waits until the service has confirmed it. */
  async edits(cell, tool = "Wall") {
    const { revision } = this.told.belief();
    await this.draws([cell], tool);
    await until("the edit is confirmed", () => this.told.belief().revision > revision);
  }

  /** Waits for the map of that revision, and returns it. */
  async waitsForRevision(revision) {
    const now = () => this.told.belief().revision;
    await until(`map revision ${revision}`, () => now() >= revision, { now });
    return this.told.belief();
  }

  /** Makes a wall of a free cell or the other way round; waits until the service has confirmed it. */
  toggles(cell) {
    return this.edits(cell, this.told.isWall(cell) ? "Erase" : "Wall");
  }

  /** Takes a tool and draws with the mouse through the middles of cells. */
  async draws([first, ...others], tool) {
    await this.tool(tool).click();
    await this.pointAt(first);
    await this.page.mouse.down();
    for (const cell of others) await this.pointAt(cell);
    await this.page.mouse.up();
  }

  /** Where a cell is while all of the map is shown: the grid in the middle of what rulers and margins leave. */
  async #centreOf({ row, column }) {
    const { rows, columns } = this.told.newest("world", "w1");
    const box = await this.map.boundingBox();
    const { left, top, scale } = fittedGrid(box, { rows, columns });
    return { x: box.x + left + (column + 0.5) * scale, y: box.y + top + (row + 0.5) * scale };
  }
}
