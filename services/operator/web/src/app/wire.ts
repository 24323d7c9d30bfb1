import { batch, computed, effect } from "@preact/signals";
import type { TextStorage } from "../connection/browser_storage";
import type { Clock } from "../connection/clock";
import type { Connection, Link } from "../connection/connection";
import { editsMap } from "../map/map_props";
import { type Announcer, announcementsOf } from "../panels/attention/announcer";
import { tourStateOf } from "../panels/guide/tour";
import { momentOf } from "../panels/replay/moment_link";
import type { Teleoperation } from "../panels/robots/teleoperation";
import { withSample } from "../panels/status/workload_history";
import { followLayout } from "../panels/task/page_layout";
import { isExperimenter, isTask, stepTitle, taskAnnouncements } from "../panels/task/task_state";
import { Mode, Severity } from "../protocol/generated/console_pb";
import type { ConsoleState } from "../state/console_state";
import { waitingItems, waitsForStart } from "../state/selectors";
import { writeSettings } from "../state/settings";
import { camerasShown, type Store, searchesShown } from "../state/store";
import type { Actions } from "./actions";
import type { Console } from "./console";
import { inWords, setWords } from "./words";

/** s between two updates of the clock and of the ages on screen. */
const tick = 0.25;

/** Updates the clock of the store and removes expired notices. */
export function keepTime(store: Store, connection: Connection, clock: Clock): void {
  clock.every(tick, () => {
    const time = connection.serviceTime();
    batch(() => {
      store.settle();
      store.now.value = store.moment.peek()?.time ?? time;
    });
    const state = store.live.peek();
    if (time !== undefined && keepsHistory(state)) store.history.add(state, time);
    const now = clock.now();
    const { notices } = store;
    if (notices.value.some(({ until }) => until <= now)) {
      notices.value = notices.value.filter(({ until }) => until > now);
    }
  });
}

/** Recordings have a time line of their own, participants have none; before the map came there is nothing to look back on. */
function keepsHistory({ welcome, worlds, robots }: ConsoleState): boolean {
  return welcome?.mode === Mode.SUPERVISE && worlds.size > 0 && robots.size > 0;
}

/** Reports activity on the page, which keeps control of robots alive. */
export function reportUse(connection: Connection, page: EventTarget): void {
  for (const kind of ["pointermove", "pointerdown", "keydown", "wheel"]) {
    page.addEventListener(kind, () => connection.used(), { capture: true, passive: true });
  }
}

/** In a mapping task and a study: tells the service where the page shows what, for eye tracking. */
export function reportLayout(store: Store, connection: Connection, page: Document): void {
  const forTask = computed(() => isTask(store.live.value) && !isExperimenter(store.live.value));
  effect(() => {
    if (!forTask.value) return undefined;
    return followLayout(page, (layout) => connection.layout(layout));
  });
}

/** Requests frames and search reports for what is on the page only, and only while it is visible. */
export function requestShown(store: Store, connection: Connection, page: Document): void {
  const ask = () => {
    const [cameras, searches] = [camerasShown(store), searchesShown(store)];
    connection.attend(page.hidden ? [] : cameras, page.hidden ? [] : searches);
  };
  effect(ask);
  page.addEventListener("visibilitychange", ask);
}

/** In a participant's page: the words of the protocol's language. The experimenter reads English. */
export function followWords(store: Store): void {
  const words = computed(() => store.live.value.task?.words);
  const leads = computed(() => isExperimenter(store.live.value));
  effect(() => setWords((leads.value ? undefined : words.value) ?? {}));
}

/** Updates announcements, workload history and tour when the state changes. */
export function followState({ store, tour, history }: Console, announcer: Announcer): void {
  let before = store.live.peek();
  effect(() => {
    const now = store.live.value;
    announcer.announce(isTask(now) ? taskAnnouncements(before, now) : announcementsOf(before, now));
    before = now;
    if (now.attention) history.value = withSample(history.peek(), now.attention);
  });
  effect(() => tour.look(tourStateOf(store)));
}

/** Warns before control of robots ends, and shows why it was lost, also after a reconnect. */
export function notifyControlLoss(
  store: Store,
  actions: Pick<Actions, "notify" | "control">,
  connection: Pick<Connection, "serviceTime">,
): void {
  effect(() => {
    const lost = actions.control.update(store.live.value, connection.serviceTime() ?? 0);
    for (const text of lost) actions.notify(text, "problem", Number.POSITIVE_INFINITY);
  });
  effect(() => {
    for (const text of actions.control.answers(store.live.value)) actions.notify(text);
  });
  effect(() => {
    const soon = actions.control.endingSoon(store.live.value, connection.serviceTime() ?? 0);
    if (soon.length === 0) return;
    actions.notify(`Your control of ${soon.join(", ")} ends in 15 s. Move the pointer to keep it.`);
  });
}

/** What the tab says: what is urgent, then how many robots wait, and a participant's step. */
export function titleOf({ live: state, link, undeliveredStop }: Store): string {
  const participates = isTask(state.value) && !isExperimenter(state.value);
  const name = (participates && inWords(stepTitle(state.value))) || "conav console";
  if (undeliveredStop.value !== undefined) return `STOP NOT DELIVERED · ${name}`;
  if (state.value.welcome !== undefined && link.value.state !== "live") return `Offline · ${name}`;
  const alarms = state.value.alerts.filter(
    ({ severity, active, acknowledgedBy }) =>
      severity === Severity.ALARM && active && acknowledgedBy === "",
  );
  if (alarms.length > 0) return `▲ ${alarms[0]?.source ?? ""} · ${name}`;
  const waiting = waitingItems(state.value).length;
  return waiting > 0 ? `(${waiting}) ${name}` : name;
}

/** Shows what is urgent in the tab, and makes it heard. */
export function callForAttention(
  store: Store,
  page: Pick<Document, "title">,
  beep: () => void,
): void {
  let before = "";
  effect(() => {
    const title = titleOf(store);
    page.title = title;
    const isUrgent = /^STOP|^▲/.test(title);
    if (isUrgent && title !== before && store.settings.peek().sound) beep();
    before = title;
  });
}

/** Announces a reconnect to screen readers. The banner announces the loss. */
export function announceReconnect(store: Store, announcer: Announcer): void {
  let wasLost = false;
  effect(() => {
    const { state } = store.link.value;
    if (state === "live" && wasLost) announcer.announce([{ text: "Reconnected", urgent: false }]);
    wasLost = state !== "live" && store.state.peek().welcome !== undefined;
  });
}

/** Opens the start dialog once per run; closes it when somebody else starts the robots. A step begins without the help and tool of the last. */
export function offerStart(store: Store): void {
  let offered = "";
  let step: string | undefined;
  effect(() => {
    const state = store.live.value;
    if (state.task !== undefined && state.task.step !== step) {
      step = state.task.step;
      store.tool.value = "look";
      if (store.dialog.peek()?.kind === "help") store.dialog.value = undefined;
    }
    const waits = waitsForStart(state);
    const dialog = store.dialog.peek();
    if (waits && offered !== state.run && dialog === undefined) {
      offered = state.run;
      store.dialog.value = { kind: "start" };
    } else if (!waits && dialog?.kind === "start") {
      store.dialog.value = undefined;
    }
  });
}

/** Shows the moment that the page's address names, once the service has answered. */
export function openLinkedMoment(
  store: Store,
  actions: Pick<Actions, "seek" | "lookBack" | "notify">,
  hash: string,
): void {
  let linked = momentOf(hash);
  effect(() => {
    const { session, playback } = store.live.value;
    const { from } = store.history.span.value;
    if (linked === undefined || session === undefined) return;
    const { run, time } = linked;
    if (playback !== undefined) actions.seek({ position: time - playback.began });
    else if (session.name === run && from > 0 && time >= from) actions.lookBack(time);
    else if (session.name === run && from === 0) return;
    else actions.notify(`This link shows a moment of run ${run}: ./conav replay runs/${run}`);
    linked = undefined;
  });
}

/** A lost link stops driving by hand. */
export function stopWithoutLink(link: Link, driving: Teleoperation): void {
  if (link.state !== "live") driving.halt();
}

/** A tool that edits takes over the arrow keys, so driving stops. */
export function stopForEditing(store: Store, driving: Teleoperation): void {
  store.tool.subscribe((tool) => {
    if (editsMap(tool)) driving.halt();
  });
}

export function keepSettings(store: Store, page: Window, kept: TextStorage): void {
  const prefersDark = page.matchMedia("(prefers-color-scheme: dark)");
  const show = () => {
    const { theme } = store.settings.value;
    const dark = theme === "dark" || (theme === "system" && prefersDark.matches);
    page.document.documentElement.dataset.theme = dark ? "dark" : "light";
  };
  effect(show);
  prefersDark.addEventListener("change", show);
  effect(() => writeSettings(kept, store.settings.value));
}
