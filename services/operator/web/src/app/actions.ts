import type { Clock } from "../connection/clock";
import type { Connection, RequestOptions } from "../connection/connection";
import type { Outcome as RequestOutcome } from "../connection/requests";
import type { CellChange, Outcome } from "../map/map_props";
import { cellPosition } from "../map/view";
import { Seeker, type SeekTarget } from "../panels/replay/playback";
import { ControlMonitor, needsReason, takeOverOf } from "../panels/robots/control";
import { isMappingTask, isTask } from "../panels/task/task_state";
import type { CellAt } from "../protocol/cells";
import type { RequestBody } from "../protocol/codec";
import { type AttentionItem, DriveAction, type Snapshot } from "../protocol/generated/console_pb";
import {
  holderOf,
  picturesSettledBy,
  questionsToMe,
  unanswered,
  worldOf,
} from "../state/selectors";
import { mostCameras, type Notice, type Store } from "../state/store";
import { QueueNavigator } from "./queue_navigator";

const noticeTime = 8;
const mostNotices = 4;
/** Validity of a low-level action, s: of simulation time when executed, of wall time when sent. Silence must soon mean stop. */
const driveValidFor = 1;
const stopValidFor = 20;
/** Long enough for a restart of the service. */
const answersValidFor = 60;
/** s after which a stop without a reply counts as not delivered. */
const stopPatience = 0.7;
const defaultGuidanceTime = 600;
const selecting = "Next";

/** What a person can do with the console. A notice says why when the service refuses. */
export class Actions {
  readonly control = new ControlMonitor();
  #store: Store;
  #connection: Connection;
  #clock: Clock;
  #notices = 0;
  #drives = 0;
  #stops = 0;
  /** The robots of each stop that the service has not confirmed. */
  #undelivered: readonly (readonly string[])[] = [];
  #walk: QueueNavigator;
  #seeker: Seeker;

  constructor(store: Store, connection: Connection, clock: Clock) {
    this.#store = store;
    this.#connection = connection;
    this.#clock = clock;
    this.#walk = new QueueNavigator(store, (body, options) => this.#request(body, options));
    this.#seeker = new Seeker((to) => connection.seek(to), clock);
  }

  /** Chooses `robot` and centres the map on it. */
  goTo(robot: string | undefined): void {
    this.#store.choose(robot);
    this.#store.centre(this.#state.robots.get(robot ?? "")?.cell);
  }

  chooseBy(step: number): void {
    const { robots, chosenRobot } = this.#store;
    const names = robots.value;
    const at = names.indexOf(chosenRobot.value ?? "");
    this.goTo(names[(at + step + names.length) % Math.max(1, names.length)]);
  }

  /** Selects the next item of the queue and shows its map and picture. Items that no longer need attention are skipped. */
  async next(): Promise<void> {
    this.lookBack(undefined);
    this.#store.settle();
    const outcome = await this.#walk.next();
    if (outcome === undefined) this.notify("Nothing needs you.");
    else this.#notifyRefusal(selecting, outcome);
  }

  async select(item: AttentionItem): Promise<void> {
    this.lookBack(undefined);
    this.#notifyRefusal(selecting, await this.#walk.select(item));
  }

  /** Shows an older (-1) or newer (1) picture of the chosen robot. */
  stepPicture(step: number): void {
    const { chosenRobot, chosenPicture, chosenSequence } = this.#store;
    const all = this.#state.pictures.get(chosenRobot.value ?? "") ?? [];
    const shown = chosenPicture.value;
    const at = (shown === undefined ? -1 : all.indexOf(shown)) + step;
    if (at < 0 || at >= all.length) return;
    chosenSequence.value = at === all.length - 1 ? undefined : all[at]?.sequenceNumber;
  }

  /** Answers "nothing new" to the chosen robot's newest picture. If an older one is shown, shows the newest first. */
  nothingNew(): void {
    const { chosenRobot, chosenPicture, chosenSequence } = this.#store;
    const picture = unanswered(this.#state, chosenRobot.value);
    if (picture === undefined) {
      this.notify("No picture of this robot is waiting for an answer.");
    } else if (chosenPicture.value === picture || isMappingTask(this.#state)) {
      this.#answer(picture);
    } else {
      chosenSequence.value = undefined;
      this.notify("This is the newest picture. Answer again if it shows nothing new.");
    }
  }

  /** An empty list stops all robots in every world. Says so while it is not delivered. */
  async stop(robots: readonly string[]): Promise<Outcome> {
    this.#stops += 1;
    const value = { robots: [...robots], reason: "by hand" };
    const warn = () => this.#showUndelivered([...this.#undelivered, robots]);
    const cancel = this.#clock.after(stopPatience, warn);
    const outcome = await this.#ask("Stop", { case: "stop", value }, { validFor: stopValidFor });
    cancel();
    if (outcome.accepted) this.#settle(robots);
    else warn();
    return outcome;
  }

  async resume(robots: readonly string[]): Promise<Outcome> {
    const body: RequestBody = { case: "resume", value: { robots: [...robots] } };
    const outcome = await this.#ask("Resume", body);
    if (outcome.accepted) this.#settle(robots);
    return outcome;
  }

  /** The service has decided about these robots, all if there are none: earlier stops of them are past. */
  #settle(robots: readonly string[]): void {
    const namesOf = (stop: readonly string[]) =>
      stop.length === 0 ? this.#store.robots.value : stop;
    const isPast = (stop: readonly string[]) =>
      robots.length === 0 || namesOf(stop).every((name) => robots.includes(name));
    this.#showUndelivered(this.#undelivered.filter((stop) => !isPast(stop)));
  }

  #showUndelivered(stops: readonly (readonly string[])[]): void {
    this.#undelivered = stops;
    const all = stops.some((stop) => stop.length === 0);
    const names = all ? [] : [...new Set(stops.flat())];
    this.#store.undeliveredStop.value = stops.length === 0 ? undefined : names;
  }

  /** Asks first if somebody else has control, and for the name of a person who has not given one. */
  takeControl(robots: readonly string[]): void {
    const takeOver = takeOverOf(this.#store.live.value, robots);
    if (needsReason(takeOver) || this.#store.name.value === "")
      this.#store.dialog.value = { kind: "take over", takeOver };
    else void this.takeControlNow(robots, "");
  }

  takeControlNow(robots: readonly string[], reason: string): Promise<Outcome> {
    const value = { robots: [...robots], reason };
    return this.#ask("Take control", { case: "takeControl", value });
  }

  /** Asks those who have control of robots to release them. */
  async askForControl(robots: readonly string[], reason: string): Promise<Outcome> {
    const value = { robots: [...robots], reason, ask: true };
    const outcome = await this.#ask("Ask for control", { case: "takeControl", value });
    if (outcome.accepted) this.control.asked(robots);
    return outcome;
  }

  /** Adds a note to the command log and the recording. */
  note(text: string): Promise<Outcome> {
    return this.#ask("Note", { case: "note", value: { text } });
  }

  /** Others see this name from now on. Control that this page has goes along. */
  async rename(name: string): Promise<void> {
    const mine = [...this.#store.live.value.controls.keys()].filter(
      (robot) => holderOf(this.#store.live.value, robot).kind === "me",
    );
    // What is released while somebody asks goes to them.
    if (questionsToMe(this.#store.live.value).length > 0) {
      this.notify("Answer who asks for control first. Your name changes with the next visit.");
      return;
    }
    if (mine.length > 0) await this.releaseControl(mine);
    await this.#connection.rename(name);
    if (mine.length > 0) await this.takeControlNow(mine, "");
  }

  /** Opens or closes a robot's camera. With one too many the oldest closes. */
  toggleCamera(robot: string): void {
    const { cameras, large } = this.#store;
    const open = cameras.value;
    cameras.value = open.includes(robot)
      ? open.filter((other) => other !== robot)
      : [...open, robot].slice(-mostCameras);
    if (large.value?.kind === "camera" && !cameras.value.includes(large.value.robot))
      large.value = undefined;
  }

  /** Shows the page as it was at `time`, wall time of the service; undefined = as it is now. */
  lookBack(time: number | undefined): void {
    const { moment, history, now } = this.#store;
    moment.value = time === undefined ? undefined : history.at(time);
    now.value = moment.value?.time ?? this.#connection.serviceTime();
  }

  /** Takes control of robots and lets them drive, unless somebody presses stop meanwhile. */
  async start(robots: readonly string[]): Promise<void> {
    const stops = this.#stops;
    const taken = await this.takeControlNow(robots, "");
    if (taken.accepted && stops === this.#stops) await this.resume(robots);
  }

  /** With `toClient` refused unless that client asks for all of them. */
  async releaseControl(robots: readonly string[], toClient = ""): Promise<Outcome> {
    this.control.beginRelease(robots);
    const value = { robots: [...robots], toClient };
    const outcome = await this.#ask("Release control", { case: "releaseControl", value });
    if (!outcome.accepted) this.control.cancelRelease(robots);
    return outcome;
  }

  /** Answers the pictures that the edit makes the map agree with; not for participants, who say so themselves. */
  async edit(world: string, cells: readonly CellChange[], baseRevision: bigint): Promise<Outcome> {
    const settled = isTask(this.#state) ? [] : picturesSettledBy(this.#state, world, cells);
    const value = { baseRevision, cells: [...cells] };
    const outcome = await this.#ask("Edit", { case: "edit", value }, { world });
    if (!outcome.accepted) return outcome;
    for (const picture of settled) {
      const waiting = unanswered(this.#state, picture.robot);
      if (waiting?.sequenceNumber === picture.sequenceNumber) this.#answer(picture);
    }
    return outcome;
  }

  #answer({ robot, sequenceNumber: snapshot, world }: Snapshot): void {
    void this.#ask("Answer", { case: "answer", value: { robot, snapshot } }, { world });
  }

  /**
   * A path answers the robot's newest picture, even when an older one is shown. An empty path withdraws the old one and answers
   * no picture: with a picture it would mean "nothing new".
   */
  guide(robot: string, path: readonly CellAt[]): Promise<Outcome> {
    const picture = path.length === 0 ? undefined : unanswered(this.#state, robot);
    const answersSnapshot = picture?.sequenceNumber ?? 0n;
    const limit = this.#state.welcome?.limits?.guidanceValidFor;
    const validFor = limit || defaultGuidanceTime;
    const value = { robot, path: [...path], answersSnapshot, validFor };
    return this.#ask("Path", { case: "guide", value }, { world: this.#worldName(robot) });
  }

  /** Goals in the middle of cells; removes those in the cells `remove`. */
  goals(robot: string, add: readonly CellAt[], remove: readonly CellAt[]): Promise<Outcome> {
    const world = worldOf(this.#state, robot);
    const places = (cells: readonly CellAt[]) =>
      world === undefined ? [] : cells.map((cell) => cellPosition(world, cell));
    const value = { robot, add: places(add), remove: places(remove) };
    return this.#ask("Goals", { case: "goals", value }, { world: world?.name ?? "" });
  }

  drive(robot: string, action: DriveAction): Promise<Outcome> {
    const world = worldOf(this.#store.live.value, robot); // the newest time, also while the person looks back
    const value = { robot, action, expiresAt: (world?.time ?? 0) + driveValidFor };
    const options = { world: world?.name ?? "", validFor: driveValidFor };
    this.#drives += 1;
    const number = this.#drives;
    // Only the newest outcome matters: of a burst the service executes the newest action.
    return this.#ask("Drive", { case: "drive", value }, options, () => number === this.#drives);
  }

  /** The participant has finished this maze. */
  finish(): Promise<Outcome> {
    return this.#ask("Finish", { case: "finish", value: {} });
  }

  /** The participant is ready: a rest begins. */
  begin(): Promise<Outcome> {
    return this.#ask("Begin", { case: "begin", value: {} });
  }

  /** The participant has filled in the form of this step. */
  answers(json: string): Promise<Outcome> {
    return this.#ask(
      "Answers",
      { case: "answers", value: { json, step: this.#step() } },
      { validFor: answersValidFor },
    );
  }

  /** Keeps a half-filled form. */
  draft(json: string): Promise<Outcome> {
    const value = { json, step: this.#step() };
    return this.#ask("Draft", { case: "draft", value }, { validFor: answersValidFor });
  }

  #step(): string {
    return this.#state.task?.step ?? "";
  }

  /** The experimenter pauses the step, or lets it go on. */
  pause(on: boolean): Promise<Outcome> {
    return this.#ask(on ? "Pause" : "Continue", { case: "pause", value: { on } });
  }

  /** The experimenter ends the step for good. */
  abort(reason: string): Promise<Outcome> {
    return this.#ask("Abort", { case: "abort", value: { reason } });
  }

  acknowledge(alert: bigint): Promise<Outcome> {
    return this.#ask("Acknowledge", { case: "acknowledge", value: { alert } });
  }

  /** `duration`: s of wall time. */
  shelve(alert: bigint, duration: number): Promise<Outcome> {
    return this.#ask("Shelve", { case: "shelve", value: { alert, duration } });
  }

  /** Moves within a recording. */
  seek(to: SeekTarget): void {
    this.#seeker.seek(to);
  }

  closeDialog(): void {
    this.#store.dialog.value = undefined;
  }

  /** Shows a notice for `time` s. */
  notify(text: string, kind: Notice["kind"] = "info", time = noticeTime): void {
    this.#notices += 1;
    const { notices } = this.#store;
    const notice = { id: this.#notices, text, kind, until: this.#clock.now() + time };
    notices.value = shortened([...notices.value.filter((other) => other.text !== text), notice]);
  }

  dismiss(id: number): void {
    const { notices } = this.#store;
    notices.value = notices.value.filter((notice) => notice.id !== id);
  }

  get #state() {
    return this.#store.state.value;
  }

  #worldName(robot: string): string {
    return worldOf(this.#state, robot)?.name ?? "";
  }

  /** `matters`: whether to show a notice on refusal. */
  async #ask(
    what: string,
    body: RequestBody,
    options: RequestOptions = {},
    matters = () => true,
  ): Promise<Outcome> {
    const outcome = this.#isPast(body)
      ? ({ kind: "refused", reason: "you are looking at the past (“Live” returns)" } as const)
      : await this.#request(body, options);
    if (matters()) this.#notifyRefusal(what, outcome);
    return toOutcome(outcome);
  }

  /** What the person sees of an earlier moment is nothing to act on. Stops, notes and control are about now. */
  #isPast(body: RequestBody): boolean {
    if (this.#store.moment.value === undefined) return false;
    if (body.case === "drive") return body.value.action !== DriveAction.DRIVE_STOP;
    return !["stop", "note", "takeControl", "releaseControl"].includes(body.case ?? "");
  }

  async #request(body: RequestBody, options: RequestOptions): Promise<RequestOutcome> {
    const { pending } = this.#store;
    pending.value += 1;
    const outcome = await this.#connection.request(body, options);
    pending.value -= 1;
    return outcome;
  }

  #notifyRefusal(what: string, outcome: RequestOutcome): void {
    if (outcome.kind !== "accepted") this.notify(`${what}: ${outcome.reason}`, "problem");
  }
}

/** Keeps the newest notices. Notices with a time limit are dropped first. */
function shortened(notices: readonly Notice[]): readonly Notice[] {
  if (notices.length <= mostNotices) return notices;
  const oldest = notices.findIndex(({ until }) => Number.isFinite(until));
  return notices.filter((_, i) => i !== Math.max(0, oldest));
}

function toOutcome(outcome: RequestOutcome): Outcome {
  return outcome.kind === "accepted"
    ? { accepted: true, reason: "" }
    : { accepted: false, reason: outcome.reason };
}
