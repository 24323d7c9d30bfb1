import { computed, type ReadonlySignal, useComputed } from "@preact/signals";
import { useMemo } from "preact/hooks";
import { mapId } from "../map/focus";
import { MapCanvas } from "../map/map_canvas";
import type { MapProps } from "../map/map_props";
import { Alerts } from "../panels/attention/alerts";
import type { Announcer } from "../panels/attention/announcer";
import { Queue } from "../panels/attention/queue";
import { EndingCard } from "../panels/guide/ending_card";
import { HelpDialog } from "../panels/guide/help_dialog";
import { StartDialog } from "../panels/guide/start_dialog";
import { TourCard } from "../panels/guide/tour_card";
import { LargeView } from "../panels/pictures/large_view";
import { Pictures } from "../panels/pictures/pictures";
import { NoteDialog } from "../panels/replay/note_dialog";
import { TimeBar } from "../panels/replay/time_bar";
import { ControlBar } from "../panels/robots/control_bar";
import { ControlQuestions } from "../panels/robots/control_questions";
import { DriveBadge } from "../panels/robots/drive_badge";
import { FleetPanel } from "../panels/robots/fleet_panel";
import { FleetStrip } from "../panels/robots/fleet_strip";
import { TakeOverDialog } from "../panels/robots/take_over_dialog";
import { Events } from "../panels/status/command_log";
import { LatencyStrip } from "../panels/status/status_strip";
import { Workload } from "../panels/status/workload";
import { ExperimenterPage } from "../panels/task/experimenter_page";
import { PageTags } from "../panels/task/page_tags";
import { StepPage } from "../panels/task/step_page";
import { BeginDialog, TaskHelp } from "../panels/task/task_dialogs";
import { isExperimenter, isMaze, isTask } from "../panels/task/task_state";
import { areAllStopped } from "../state/selectors";
import { Brand } from "./brand";
import { type Console, ConsoleContext, useConsole } from "./console";
import { LinkBanner, UndeliveredStop } from "./link_banner";
import { LiveRegions } from "./live_regions";
import { mapView } from "./map_view";
import { Notices } from "./notices";
import "./layout.css";

export function App({ console, announcer }: { console: Console; announcer: Announcer }) {
  return (
    <ConsoleContext.Provider value={console}>
      <SkipLink />
      <Layout />
      <PageTags />
      <Notices />
      <Dialogs />
      <LiveRegions announcer={announcer} />
    </ConsoleContext.Provider>
  );
}

/** On pages with a map. It comes before the words of a participant's page, and is drawn again with them. */
function SkipLink() {
  const { store } = useConsole();
  const language = useComputed(() => store.state.value.task?.language).value;
  const hasMap = useComputed(() => {
    const { task } = store.state.value;
    return task === undefined || isMaze(task);
  }).value;
  if (!hasMap) return null;
  return (
    <a key={language} class="skip" href={`#${mapId}`}>
      Skip to the map
    </a>
  );
}

/** The supervisor's page, or that of a participant in a mapping task or a study, or of its experimenter. */
function Layout() {
  const { store } = useConsole();
  const forTask = useComputed(() => isTask(store.state.value)).value;
  const leads = useComputed(() => isExperimenter(store.state.value)).value;
  const maze = useComputed(() => {
    const { task } = store.state.value;
    return task && `${task.number} ${task.step}`;
  }).value;
  const stopped = useComputed(() => areAllStopped(store.state.value)).value;
  // Each maze gets its own map, so that edits of the previous one cannot be undone.
  const map = <WorldMap key={maze} />;
  if (forTask) return leads ? <ExperimenterPage map={map} /> : <StepPage map={map} />;
  return (
    <div class={`console ${stopped ? "all-stopped" : ""}`}>
      <header class="top">
        <Brand />
        <FleetStrip />
        <ControlBar />
      </header>
      <LinkBanner />
      <UndeliveredStop />
      <Stage />
      <aside class="side" aria-label="Attention">
        <Queue />
        <DriveBadge />
        <Pictures />
        <Alerts />
      </aside>
      <TimeBar />
      <LatencyStrip />
    </div>
  );
}

function Stage() {
  const { settings } = useConsole().store;
  const { workload, events, fleet } = settings.value;
  return (
    <main class="stage">
      {/* The live region must exist before its cards, or screen readers do not read them. */}
      <div class="cards" aria-live="polite">
        <TourCard />
        <EndingCard />
        <ControlQuestions />
      </div>
      <div class="map" data-tour="map" data-area="map">
        <WorldMap />
      </div>
      <LargeView />
      {(workload || events || fleet) && (
        <div class="drawers">
          {fleet && <FleetPanel />}
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
  const first = useComputed(() => view.value !== undefined).value ? view.peek() : undefined;
  if (first === undefined) return <p class="quiet">Waiting for the map.</p>;
  return <KnownMap view={view} first={first} />;
}

/** A world does not get lost again: the map keeps what it showed last. */
function KnownMap(props: { view: ReadonlySignal<MapProps | undefined>; first: MapProps }) {
  const { view, first } = props;
  const known = useMemo(() => {
    let kept = first;
    return computed(() => {
      kept = view.value ?? kept;
      return kept;
    });
  }, [view]);
  return <MapCanvas view={known} />;
}

function Dialogs() {
  const { dialog, state } = useConsole().store;
  const forTask = useComputed(() => isTask(state.value)).value;
  const covered = useComputed(() => state.value.task?.paused === true).value;
  if (covered) return undefined;
  switch (dialog.value?.kind) {
    case "help":
      return forTask ? <TaskHelp /> : <HelpDialog />;
    case "start":
      return forTask ? <BeginDialog /> : <StartDialog />;
    case "note":
      return <NoteDialog />;
    case "take over":
      return <TakeOverDialog takeOver={dialog.value.takeOver} />;
    default:
      return undefined;
  }
}
