import { effect } from "@preact/signals";
import type { TextStorage } from "../connection/browser_storage";
import type { Clock } from "../connection/clock";
import type { Connection, Link } from "../connection/connection";
import { editsMap } from "../map/map_props";
import { type Announcer, announcementsOf } from "../panels/attention/announcer";
import { tourStateOf } from "../panels/guide/tour";
import type { Teleoperation } from "../panels/robots/teleoperation";
import { withSample } from "../panels/status/workload_history";
import { isTask, taskAnnouncements } from "../panels/task/task_state";
import { waitsForStart } from "../state/selectors";
import { writeSettings } from "../state/settings";
import type { Store } from "../state/store";
import type { Actions } from "./actions";
import type { Console } from "./console";

/** s between two looks at the clock: ages on screen are so old at most. */
const tick = 0.25;

/** Time: what is shown of ages, and notices that go. */
export function keepTime(store: Store, connection: Connection, clock: Clock): void {
  clock.every(tick, () => {
    store.now.value = connection.serviceTime();
    const now = clock.now();
    const { notices } = store;
    if (notices.value.some(({ until }) => until <= now)) {
      notices.value = notices.value.filter(({ until }) => until > now);
    }
  });
}

/** Whoever looks round, reads or draws is there: what they control stays theirs. */
export function reportUse(connection: Connection, page: EventTarget): void {
  for (const kind of ["pointermove", "pointerdown", "keydown", "wheel"]) {
    page.addEventListener(kind, () => connection.used(), { capture: true, passive: true });
  }
}

/** Frames come only for the robot that is looked at, while the page is. */
export function requestFrames(store: Store, connection: Connection, page: Document): void {
  const ask = () => {
    const streams = store.state.value.session?.streams ?? false;
    const robot = store.chosenRobot.value;
    connection.attend(streams && !page.hidden ? robot : undefined);
  };
  effect(ask);
  page.addEventListener("visibilitychange", ask);
}

/** What follows from what the service tells. */
export function follow({ store, tour, history }: Console, announcer: Announcer): void {
  let before = store.state.peek();
  effect(() => {
    const now = store.state.value;
    announcer.tell(isTask(now) ? taskAnnouncements(before, now) : announcementsOf(before, now));
    before = now;
    if (now.attention) history.value = withSample(history.peek(), now.attention);
  });
  effect(() => tour.look(tourStateOf(store)));
}

/** Whoever loses control of robots reads why, also when they come back later. */
export function notifyControlLoss(
  store: Store,
  actions: Pick<Actions, "notify" | "control">,
  connection: Pick<Connection, "serviceTime">,
): void {
  effect(() => {
    const lost = actions.control.look(store.state.value, connection.serviceTime() ?? 0);
    for (const text of lost) actions.notify(text, "problem", Number.POSITIVE_INFINITY);
  });
}

/** For screen readers, that what is shown is new again; that it is old says the banner. */
export function announceReconnect(store: Store, announcer: Announcer): void {
  let wasLost = false;
  effect(() => {
    const { state } = store.link.value;
    if (state === "live" && wasLost) announcer.tell([{ text: "Connected again", urgent: false }]);
    wasLost = state !== "live" && store.state.peek().welcome !== undefined;
  });
}

/** Offers to begin, once per run; whoever begins elsewhere ends the offer. */
export function offerStart(store: Store): void {
  let offered = "";
  effect(() => {
    const state = store.state.value;
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

/** Silence stops what is driven by hand. */
export function stopWithoutLink(link: Link, driving: Teleoperation): void {
  if (link.state !== "live") driving.halt();
}

/** The arrow keys drive no longer, so what they began ends. */
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
