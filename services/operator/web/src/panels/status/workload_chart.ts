import uPlot from "uplot";
import type { History } from "./workload_history";
import "uplot/dist/uPlot.min.css";

export interface Chart {
  show(history: History): void;
  destroy(): void;
}

/** A chart that fills `place` and uses the theme's colours. */
export function makeChart(place: HTMLElement, history: History): Chart {
  const plot = new uPlot(optionsOf(place), toData(history), place);
  const observer = new ResizeObserver(() => plot.setSize(sizeOf(place)));
  observer.observe(place);
  return {
    show: (now) => plot.setData(toData(now)),
    destroy: () => {
      observer.disconnect();
      plot.destroy();
    },
  };
}

function optionsOf(place: HTMLElement): uPlot.Options {
  const style = getComputedStyle(place);
  const colour = (name: string) => style.getPropertyValue(name).trim();
  const axis = {
    stroke: colour("--muted"),
    grid: { stroke: colour("--line"), width: 0.5 },
    size: 54,
  };
  return {
    ...sizeOf(place),
    legend: { show: false },
    cursor: { show: false },
    scales: { x: { time: false }, y: { range: [0, 1] }, robots: { range: [0, null] } },
    axes: [
      { ...axis, size: 26, values: (_, ticks) => ticks.map((tick) => `${tick} s`) },
      { ...axis, values: (_, ticks) => ticks.map((tick) => `${Math.round(tick * 100)} %`) },
      { ...axis, scale: "robots", side: 1, grid: { show: false } },
    ],
    series: [
      {},
      { label: "utilisation", stroke: colour("--accent"), width: 2 },
      { label: "waiting", scale: "robots", stroke: colour("--warn"), width: 1, dash: [4, 3] },
    ],
  };
}

function sizeOf(place: HTMLElement): { width: number; height: number } {
  return { width: Math.max(80, place.clientWidth), height: Math.max(60, place.clientHeight) };
}

function toData({ time, utilisation, waiting }: History): uPlot.AlignedData {
  return [[...time], [...utilisation], [...waiting]];
}
