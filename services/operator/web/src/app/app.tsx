import { useComputed } from "@preact/signals";
import { useMemo } from "preact/hooks";
import { MapCanvas } from "../map/map_canvas";
import { mapId } from "../map/map_focus";
import { Alerts } from "../panels/alerts/alerts";
import type { Announcer } from "../panels/announcements/announcer";
import { LiveRegions } from "../panels/announcements/live_regions";
import { ControlBar } from "../panels/control/control_bar";
import { TakeOverDialog } from "../panels/control/take_over_dialog";
import { EndingCard } from "../panels/ending/ending_card";
import { Events } from "../panels/events/events";
import { FleetStrip } from "../panels/fleet/fleet_strip";
import { HelpDialog } from "../panels/help/help_dialog";
import { LatencyStrip } from "../panels/latency/latency_strip";
import { Notices } from "../panels/notices/notices";
import { Pictures } from "../panels/pictures/pictures";
import { Queue } from "../panels/queue/queue";
import { ReplayBar } from "../panels/replay/replay_bar";
import { StartDialog } from "../panels/start/start_dialog";
import { BeginDialog } from "../panels/task/begin_dialog";
import { TaskHelp } from "../panels/task/task_help";
import { TaskPage } from "../panels/task/task_page";
import { isTask } from "../panels/task/task_state";
import { DriveBadge } from "../panels/teleoperation/drive_badge";
import { TourCard } from "../panels/tour/tour_card";
import { Workload } from "../panels/workload/workload";
import { type Console, ConsoleContext, useConsole } from "./console";
import { LinkBanner } from "./link_banner";
import { mapView } from "./map_view";
import "./layout.css";

export function App({ console, announcer }: { console: Console; announcer: Announcer }) {
  return (
    <ConsoleContext.Provider value={console}>
      <a class="skip" href={`#${mapId}`}>
        To the map
      </a>
      <Layout />
      <Notices />
      <Dialogs />
      <LiveRegions announcer={announcer} />
    </ConsoleContext.Provider>
  );
}

/** For whoever supervises, or for a participant of a mapping task or a study. */
function Layout() {
  const { store } = useConsole();
  const forTask = useComputed(() => isTask(store.state.value)).value;
  const maze = useComputed(() => store.state.value.task?.number).value;
  // A map of its own for each maze: what could be undone in the one before is over.
  if (forTask) return <TaskPage map={<WorldMap key={maze} />} />;
  return (
    <div class="console">
      <header class="top">
        <h1 class="unseen">conav console</h1>
        <FleetStrip />
        <ControlBar />
      </header>
      <LinkBanner />
      <Stage />
      <aside class="side" aria-label="Attention">
        <Queue />
        <Pictures />
        <Alerts />
      </aside>
      <ReplayBar />
      <LatencyStrip />
    </div>
  );
}

function Stage() {
  const { settings } = useConsole().store;
  const { workload, events } = settings.value;
  return (
    <main class="stage">
      {/* There before its cards are: only then is what comes into it read aloud. */}
      <div class="cards" aria-live="polite">
        <TourCard />
        <EndingCard />
      </div>
      <DriveBadge />
      <div class="map" data-tour="map">
        <WorldMap />
      </div>
      {(workload || events) && (
        <div class="drawers">
          {workload && <Workload />}
          {events && <Events />}
        </div>
      )}
    </main>
  );
}

function WorldMap() {
  const { store, actions } = useConsole();
  const view = useMemo(() => mapView(store, actions), [store, actions]);
  const props = view.value;
  return props === undefined ? (
    <p class="quiet">The world has not come yet.</p>
  ) : (
    <MapCanvas {...props} />
  );
}

function Dialogs() {
  const { dialog, state } = useConsole().store;
  const forTask = useComputed(() => isTask(state.value)).value;
  switch (dialog.value?.kind) {
    case "help":
      return forTask ? <TaskHelp /> : <HelpDialog />;
    case "start":
      return forTask ? <BeginDialog /> : <StartDialog />;
    case "take over":
      return <TakeOverDialog takeOver={dialog.value.takeOver} />;
    default:
      return undefined;
  }
}
