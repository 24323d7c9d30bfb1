import type { ComponentChildren } from "preact";

/** One cell of the map, 20 x 20. */
export function Cell({
  fill = "var(--map-free)",
  children,
}: {
  fill?: string;
  children?: ComponentChildren;
}) {
  return (
    <svg class="map-sign" viewBox="0 0 20 20" aria-hidden="true">
      <rect x="0.5" y="0.5" width="19" height="19" fill={fill} stroke="var(--map-muted)" />
      {children}
    </svg>
  );
}

export function Lines({ d, stroke, width = 2 }: { d: string; stroke: string; width?: number }) {
  return <path d={d} fill="none" stroke={stroke} stroke-width={width} />;
}

export function Tint({ fill }: { fill: string }) {
  return <rect x="1" y="1" width="18" height="18" fill={fill} opacity="0.35" />;
}

export const rising = "M1 7 7 1M1 13 13 1M1 19 19 1M7 19 19 7M13 19 19 13";
export const falling = "M1 13 7 19M1 7 13 19M1 1 19 19M7 1 19 13M13 1 19 7";
export const frame = "M4 4h12v12H4zM4 10l6-6M4 16 16 4M10 16l6-6";
export const flag = "M5 18V2l12 2.5-2 3 2 3L5 11";

export function Mark({
  fill,
  dash,
  children,
}: {
  fill: string;
  dash?: string;
  children?: ComponentChildren;
}) {
  return (
    <svg class="map-sign" viewBox="0 0 20 20" aria-hidden="true">
      <path d="M19.5 10 14 7v6z" fill={fill} stroke="var(--map-ink)" />
      <circle cx="9" cy="10" r="6.5" fill={fill} stroke="var(--map-ink)" stroke-dasharray={dash} />
      {children}
    </svg>
  );
}
