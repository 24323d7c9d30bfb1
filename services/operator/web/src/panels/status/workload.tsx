import { useEffect, useRef, useState } from "preact/hooks";
import { useConsole } from "../../app/console";
import { watchTheme } from "../../map/draw/palette";
import { duration, measured, percent } from "../format";
import type { Chart } from "./workload_chart";
import { loadLevel } from "./workload_history";
import "./status.css";

/** The operator's workload as measured by the service, with a chart over time. */
export function Workload() {
  const { store } = useConsole();
  const attention = store.state.value.attention;
  const load = attention?.utilisation ?? 0;
  const level = loadLevel(load);
  const kind = { calm: "good", busy: "warn", overloaded: "bad" }[level];
  return (
    <section class="panel workload" aria-label="Workload">
      <h2>Your workload</h2>
      <dl>
        <Value name="Utilisation" help="Share of your time spent on questions" kind={kind}>
          {percent(load)} {level}
        </Value>
        <Value name="Interaction time" help="From selecting a question to your last command">
          {duration(attention?.interactionTime || undefined)}
        </Value>
        <Value name="Neglect time" help="How long a robot works without you">
          {duration(attention?.neglectTime || undefined)}
        </Value>
        <Value name="Fan-out" help="Robots that were not waiting for you (measured)">
          {measured(attention?.attendedRobots)}
        </Value>
        <Value name="Fan-out possible" help="Neglect time / interaction time + 1">
          {measured(attention?.fanOut)}
        </Value>
        <Value name="Expected wait" help="Wait of a question in a queue of this many robots">
          {duration(attention?.predictedWaitingTime || undefined)}
        </Value>
      </dl>
      <WorkloadChart />
    </section>
  );
}

interface ValueProps {
  name: string;
  help: string;
  kind?: string;
  children: preact.ComponentChildren;
}

function Value({ name, help, kind = "", children }: ValueProps) {
  return (
    <div title={help}>
      <dt class="quiet">{name}</dt>
      <dd class={kind}>{children}</dd>
    </div>
  );
}

function WorkloadChart() {
  const { history } = useConsole();
  const place = useRef<HTMLDivElement>(null);
  const chart = useRef<Chart | undefined>(undefined);
  const colours = useColours();
  useEffect(() => {
    let gone = false;
    // Loads the chart library only when the panel is opened.
    void import("./workload_chart").then(({ makeChart }) => {
      if (!gone && place.current) chart.current = makeChart(place.current, history.peek());
    });
    return () => {
      gone = true;
      chart.current?.destroy();
      chart.current = undefined;
    };
  }, [history, colours]);
  const now = history.value;
  useEffect(() => chart.current?.show(now), [now]);
  return (
    <div
      ref={place}
      class="chart"
      role="img"
      aria-label="Utilisation and waiting robots over time"
    />
  );
}

/** A number that changes with the page's colours. */
function useColours(): number {
  const [colours, setColours] = useState(0);
  useEffect(() => watchTheme(() => setColours((before) => before + 1)), []);
  return colours;
}
