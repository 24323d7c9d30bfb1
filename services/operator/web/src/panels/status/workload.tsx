import { useEffect, useRef, useState } from "preact/hooks";
import { useConsole } from "../../app/console";
import { watchTheme } from "../../map/draw/palette";
import { duration, measured, percent } from "../format";
import type { Chart } from "./workload_chart";
import { loadLevel } from "./workload_history";
import "./status.css";

/** How busy the operator is, measured by the service; over time as a chart. */
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
        <Value name="Utilisation" help="Share of your time that questions took" kind={kind}>
          {percent(load)} {level}
        </Value>
        <Value name="Interaction time" help="From turning to a question to your last command">
          {duration(attention?.interactionTime || undefined)}
        </Value>
        <Value name="Neglect time" help="How long a robot gets along without you">
          {duration(attention?.neglectTime || undefined)}
        </Value>
        <Value name="Fan-out" help="Robots that did not wait for you, measured">
          {measured(attention?.attendedRobots)}
        </Value>
        <Value name="Fan-out possible" help="Neglect time / interaction time + 1">
          {measured(attention?.fanOut)}
        </Value>
        <Value name="Expected wait" help="Of a question in a queue of this many robots">
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
    // Most never open this panel: its library comes when they do.
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

/** Another number whenever the page has other colours, also because the system has. */
function useColours(): number {
  const [colours, setColours] = useState(0);
  useEffect(() => watchTheme(() => setColours((before) => before + 1)), []);
  return colours;
}
