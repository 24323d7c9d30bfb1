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

  /** @param {string} url */
  async open(url) {
    await this.page.goto(url);
    await this.hasRobots();
  }

  /** The page shows robots, and the link is live. */
  async hasRobots() {
    await this.page.locator(".fleet-card").first().waitFor();
    await this.link("live");
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
    return this.page.locator(".fleet-card").filter({ has: this.page.getByText(robot, { exact: true }) });
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
    const card = this.card(robot).locator(".choose");
    await card.click();
    await until(`${robot} is chosen`, async () => (await card.getAttribute("aria-pressed")) === "true");
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
    const before = this.told.robot(robot).cellMoves;
    await until(`${robot} moves on`, () => this.told.robot(robot).cellMoves > before);
  }

  /** Waits until the robot is under no command any more, so that from then on it stands. */
  async stands(robot) {
    const running = 1; // CommandOutcome
    await until(`${robot} ends its command`, () => this.told.robot(robot).outcome !== running);
  }
}
