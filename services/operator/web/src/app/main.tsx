// First, because the panels' styles build on it.
import "./theme.css";

import { signal } from "@preact/signals";
import { render } from "preact";
import { pageClock } from "../connection/clock";
import { browserEnvironment, identify, rememberName } from "../connection/identity";
import { ServiceConnection } from "../connection/service_connection";
import { serviceUrl, webSocketFactory } from "../connection/socket";
import { Announcer } from "../panels/attention/announcer";
import { Tour } from "../panels/guide/tour";
import { Pixels } from "../panels/pictures/pixels";
import { driveBlockedReason, Teleoperation } from "../panels/robots/teleoperation";
import { emptyHistory } from "../panels/status/workload_history";
import { isTask } from "../panels/task/task_state";
import { Inbox } from "../state/inbox";
import { readSettings } from "../state/settings";
import { createStore } from "../state/store";
import { Actions } from "./actions";
import { App } from "./app";
import { commandsOf } from "./commands";
import type { Console } from "./console";
import { followGamepad } from "./gamepad";
import { listenToKeys } from "./keyboard";
import { beep } from "./sound";
import {
  announceReconnect,
  callForAttention,
  followState,
  followWords,
  keepSettings,
  keepTime,
  notifyControlLoss,
  offerStart,
  openLinkedMoment,
  reportLayout,
  reportUse,
  requestShown,
  stopForEditing,
  stopWithoutLink,
} from "./wire";

const clock = pageClock;
const environment = browserEnvironment(window);
const identity = identify(environment);
const store = createStore(readSettings(environment.localStorage));
store.name.value = identity.isNamed ? identity.name : "";
const inbox = new Inbox(store, clock, () => connection.shown());
const connection = new ServiceConnection({
  sockets: webSocketFactory(serviceUrl(location)),
  clock,
  identity,
  known: () => {
    inbox.empty();
    return store.live.peek();
  },
  events: {
    linkChanged: (link) => {
      store.link.value = link;
      stopWithoutLink(link, teleoperation);
    },
    received: (message) => inbox.receive(message),
    timingChanged: (timing) => {
      store.timing.value = timing;
    },
  },
});
const actions = new Actions(store, connection, clock);
const teleoperation = new Teleoperation({
  clock,
  drive: (robot, action) => void actions.drive(robot, action),
  chosenRobot: () => store.chosenRobot.peek(),
  blockedReason: (robot) =>
    driveBlockedReason(
      store.state.peek(), // the past cannot be driven
      store.link.peek(),
      store.timing.peek(),
      connection.serviceTime(),
      robot,
    ),
  blocked: (reason) => actions.notify(`You cannot drive: ${reason}.`, "problem"),
});
const commands = commandsOf(store, actions);
const console: Console = {
  store,
  actions,
  commands,
  teleoperation,
  pixels: new Pixels({
    token: identity.token,
    fetch: (path, init) => fetch(path, init),
    createUrl: (blob) => URL.createObjectURL(blob),
    revokeUrl: (url) => URL.revokeObjectURL(url),
  }),
  tour: new Tour(),
  history: signal(emptyHistory),
  rename: (name) => {
    store.name.value = name.trim();
    return actions.rename(rememberName(environment, name));
  },
};
const announcer = new Announcer(clock);

keepSettings(store, window, environment.localStorage);
keepTime(store, connection, clock);
reportUse(connection, window);
reportLayout(store, connection, document);
requestShown(store, connection, document);
followWords(store);
followState(console, announcer);
announceReconnect(store, announcer);
notifyControlLoss(store, actions, connection);
callForAttention(store, document, beep);
offerStart(store);
stopForEditing(store, teleoperation);
listenToKeys(window, store, commands, teleoperation);
followGamepad(
  // Missing where the page comes over plain HTTP from another host. Participants drive with keys only.
  () => (isTask(store.live.peek()) ? [] : (navigator.getGamepads?.() ?? [])),
  document,
  () => store.dialog.peek() === undefined,
  teleoperation,
  commands["stop robot"],
  clock,
);
openLinkedMoment(store, actions, location.hash);

const root = document.getElementById("app");
if (root) render(<App console={console} announcer={announcer} />, root);
connection.start();
