import type { ComponentChildren } from "preact";
import { lookOf } from "../../app/palette";
import { LayerSwatch } from "../../map/layer_swatch";

interface Sign {
  readonly text: string;
  readonly sign: ComponentChildren;
  /** Of what participants are not told, and of where no paths are given. */
  readonly secret?: true;
  readonly path?: true;
}

const { colour } = lookOf(0);

/** One cell of the map, 20 x 20. */
function Cell({
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

function Lines({ d, stroke, width = 2 }: { d: string; stroke: string; width?: number }) {
  return <path d={d} fill="none" stroke={stroke} stroke-width={width} />;
}

function Tint({ fill }: { fill: string }) {
  return <rect x="1" y="1" width="18" height="18" fill={fill} opacity="0.35" />;
}

const rising = "M1 7 7 1M1 13 13 1M1 19 19 1M7 19 19 7M13 19 19 13";
const falling = "M1 13 7 19M1 7 13 19M1 1 19 19M7 1 19 13M13 1 19 7";
const frame = "M4 4h12v12H4zM4 10l6-6M4 16 16 4M10 16l6-6";
const flag = "M5 18V2l12 2.5-2 3 2 3L5 11";

function Mark({
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

const signs: readonly Sign[] = [
  { text: "Wall on your map", sign: <Cell fill="var(--map-wall)" /> },
  { text: "Free on your map", sign: <Cell /> },
  { text: "Border: cannot be edited", sign: <Cell fill="var(--map-border)" /> },
  {
    text: "Greyed: no robot has seen it yet",
    sign: (
      <Cell>
        <rect x="1" y="1" width="18" height="18" fill="var(--map-fog)" />
      </Cell>
    ),
    secret: true,
  },
  {
    text: "You made it a wall",
    sign: (
      <Cell fill="var(--map-wall)">
        <Tint fill="var(--map-changed)" />
        <Lines d="M5 10h10M10 5v10" stroke="var(--map-changed)" />
      </Cell>
    ),
  },
  {
    text: "You took the wall away",
    sign: (
      <Cell>
        <Tint fill="var(--map-changed)" />
        <Lines d="M5 10h10" stroke="var(--map-changed)" />
      </Cell>
    ),
  },
  {
    text: "Robots saw a wall, your map has none",
    sign: (
      <Cell>
        <Lines d={frame} stroke="var(--map-differs)" width={1.5} />
      </Cell>
    ),
    secret: true,
  },
  {
    text: "Robots saw no wall, your map has one",
    sign: (
      <Cell fill="var(--map-wall)">
        <circle cx="10" cy="10" r="5" fill="none" stroke="var(--map-differs)" stroke-width="2" />
      </Cell>
    ),
    secret: true,
  },
  {
    text: "Expected of you: + a wall (a layer)",
    sign: (
      <Cell>
        <Tint fill="var(--map-add)" />
        <Lines d={rising} stroke="var(--map-add)" width={1.5} />
      </Cell>
    ),
    secret: true,
  },
  {
    text: "Expected of you: − a wall (a layer)",
    sign: (
      <Cell fill="var(--map-wall)">
        <Tint fill="var(--map-remove)" />
        <Lines d={falling} stroke="var(--map-remove)" width={1.5} />
      </Cell>
    ),
    secret: true,
  },
  {
    text: "Where a picture was taken; filled while it waits for an answer",
    sign: (
      <Cell>
        <path d="M3 10 16 4q3 6 0 12z" fill={colour} fill-opacity="0.45" stroke={colour} />
      </Cell>
    ),
  },
  {
    text: "Free in the picture shown",
    sign: (
      <Cell>
        <circle cx="10" cy="10" r="3" fill={colour} />
      </Cell>
    ),
    secret: true,
  },
  {
    text: "Wall in the picture shown",
    sign: (
      <Cell>
        <Lines d="M3 3h14v14H3zM3 10l7 7M3 3l14 14M10 3l7 7" stroke={colour} width={1.5} />
      </Cell>
    ),
    secret: true,
  },
  { text: "Trail: where a robot has been", sign: <LayerSwatch name="trails" /> },
  { text: "Path that was given to a robot", sign: <LayerSwatch name="paths" />, path: true },
  { text: "Plan: where it means to go next", sign: <LayerSwatch name="plan" />, secret: true },
  {
    text: "Goal of the robot of this colour and letter",
    sign: (
      <Cell>
        <path d={flag} fill={colour} stroke="var(--map-ink)" />
      </Cell>
    ),
  },
  {
    text: "Goal reached",
    sign: (
      <Cell>
        <Lines d={flag} stroke={colour} width={1.5} />
        <Lines d="M7 6.5l2 2 4-4" stroke="var(--map-ink)" width={1.5} />
      </Cell>
    ),
  },
  { text: "Robot and where it looks", sign: <Mark fill={colour} /> },
  { text: "Robot that is stale: not heard for a second", sign: <Mark fill={colour} dash="3 3" /> },
  {
    text: "Robot that is lost: where it was last",
    sign: (
      <Mark fill="var(--map-free)" dash="3 3">
        <text x="13" y="8" class="question">
          ?
        </text>
      </Mark>
    ),
  },
];

/** What the map's colours and shapes mean. As `participates` and `offersPaths` of MapProps. */
export function MapSigns(props: { participates: boolean; offersPaths: boolean }) {
  const told = signs
    .filter(({ secret }) => !(secret && props.participates))
    .filter(({ path }) => !path || props.offersPaths);
  return (
    <section class="map-signs">
      <h3>What the map shows</h3>
      <ul>
        {told.map(({ text, sign }) => (
          <li key={text}>
            {sign}
            {text}
          </li>
        ))}
      </ul>
    </section>
  );
}
