import type { ComponentChildren } from "preact";
import { lookOf } from "../../app/palette";
import { LayerSwatch } from "../../map/icons";
import { Cell, falling, flag, frame, Lines, Mark, rising, Tint } from "./sign_shapes";

interface Sign {
  readonly text: string;
  readonly sign: ComponentChildren;
  /** Hidden from participants. */
  readonly secret?: true;
  /** Shown only where robots follow paths. */
  readonly path?: true;
}

const { colour } = lookOf(0);

/** In the order of the help. */
export const signs: readonly Sign[] = [
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
    text: "Wall that you added",
    sign: (
      <Cell fill="var(--map-wall)">
        <Tint fill="var(--map-changed)" />
        <Lines d="M4 10h12M10 4v12" stroke="var(--map-changed)" width={3.5} />
      </Cell>
    ),
  },
  {
    text: "Wall that you removed",
    sign: (
      <Cell>
        <Tint fill="var(--map-changed)" />
        <Lines d="M4 10h12" stroke="var(--map-changed)" width={3.5} />
      </Cell>
    ),
  },
  {
    text: "Robots saw a wall that your map lacks",
    sign: (
      <Cell>
        <Lines d={frame} stroke="var(--map-differs)" width={1.5} />
      </Cell>
    ),
    secret: true,
  },
  {
    text: "Robots saw no wall where your map has one",
    sign: (
      <Cell fill="var(--map-wall)">
        <circle cx="10" cy="10" r="5" fill="none" stroke="var(--map-differs)" stroke-width="2" />
      </Cell>
    ),
    secret: true,
  },
  {
    text: "Wall that you are expected to add (a layer)",
    sign: (
      <Cell>
        <Tint fill="var(--map-add)" />
        <Lines d={rising} stroke="var(--map-add)" width={1.5} />
      </Cell>
    ),
    secret: true,
  },
  {
    text: "Wall that you are expected to remove (a layer)",
    sign: (
      <Cell>
        <Tint fill="var(--map-remove)" />
        <Lines d={falling} stroke="var(--map-remove)" width={1.5} />
      </Cell>
    ),
    secret: true,
  },
  {
    text: "Where a picture was taken; filled: waiting for an answer",
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
  { text: "Path given to a robot", sign: <LayerSwatch name="paths" />, path: true },
  { text: "Plan: where a robot goes next", sign: <LayerSwatch name="plan" />, secret: true },
  {
    text: "Goal of the robot with this colour and letter",
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
  { text: "Robot and its heading", sign: <Mark fill={colour} /> },
  { text: "Stale robot: silent for 1 s", sign: <Mark fill={colour} dash="3 3" /> },
  {
    text: "Lost robot: last known position",
    sign: (
      <Mark fill="var(--map-free)" dash="3 3">
        <text x="13" y="8" class="question">
          ?
        </text>
      </Mark>
    ),
  },
];
