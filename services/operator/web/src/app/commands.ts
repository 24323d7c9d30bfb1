import { sortAlerts } from "../panels/attention/alert_order";
import { jump, togglePlay } from "../panels/replay/playback";
import { Mode } from "../protocol/generated/console_pb";
import type { Settings, Theme } from "../state/settings";
import type { Store } from "../state/store";
import type { Actions } from "./actions";
import type { Commands } from "./shortcuts";

const themes: readonly Theme[] = ["system", "dark", "light"];

/** The actions behind the shortcuts. */
export function commandsOf(store: Store, actions: Actions): Commands {
  const chosen = () => (store.chosenRobot.value === undefined ? [] : [store.chosenRobot.value]);
  /** An empty list would mean all robots. */
  const withChosen = (act: (robots: string[]) => unknown) => () => {
    if (chosen().length > 0) act(chosen());
    else actions.notify("Choose a robot first.");
  };
  const set = (change: (settings: Settings) => Partial<Settings>) => () => {
    store.settings.value = { ...store.settings.value, ...change(store.settings.value) };
  };
  return {
    "stop all": () => void actions.stop([]),
    "stop robot": withChosen((robots) => actions.stop(robots)),
    "resume robot": withChosen((robots) => actions.resume(robots)),
    "resume all": () => void actions.resume(store.robots.value),
    "take control": withChosen((robots) => actions.takeControl(robots)),
    "release control": withChosen((robots) => actions.releaseControl(robots)),
    next: () => void actions.next(),
    "nothing new": () => actions.nothingNew(),
    "older picture": () => actions.stepPicture(-1),
    "newer picture": () => actions.stepPicture(1),
    "next robot": () => actions.chooseBy(1),
    "previous robot": () => actions.chooseBy(-1),
    centre: () => actions.goTo(store.chosenRobot.value),
    acknowledge: () => acknowledgeMostSevere(store, actions),
    workload: set(({ workload }) => ({ workload: !workload })),
    events: set(({ events }) => ({ events: !events })),
    fleet: set(({ fleet }) => ({ fleet: !fleet })),
    camera: () => openCamera(store, actions),
    note: () => {
      if (store.live.value.welcome?.mode === Mode.SUPERVISE) store.dialog.value = { kind: "note" };
    },
    "close view": () => {
      store.large.value = undefined;
    },
    theme: set(({ theme }) => ({ theme: themes[(themes.indexOf(theme) + 1) % 3] ?? "system" })),
    help: () => {
      store.dialog.value = { kind: "help" };
    },
    play: () => togglePlay(store, actions),
    "mark before": () => jump(store, actions, -1),
    "mark after": () => jump(store, actions, 1),
  };
}

/** Methods that stream show the chosen robot's camera anyway. */
function openCamera(store: Store, actions: Actions): void {
  const robot = store.chosenRobot.value;
  if (robot === undefined) actions.notify("Choose a robot first.");
  else if (!store.live.value.session?.streams) actions.toggleCamera(robot);
}

function acknowledgeMostSevere(store: Store, actions: Actions): void {
  const { active } = sortAlerts(store.state.value.alerts, store.now.value ?? 0);
  const mostSevere = active.find(({ acknowledgedBy }) => acknowledgedBy === "");
  if (mostSevere) void actions.acknowledge(mostSevere.id);
  else actions.notify("There is no alert to acknowledge.");
}
