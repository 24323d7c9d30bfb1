import { useConsole } from "../../app/console";
import { isExperimenter } from "./task_state";
import "./task.css";

const inner = 6;

/** AprilTags at the left and right edges of a participant's page, by which an eye tracker finds it. */
export function PageTags() {
  const state = useConsole().store.state.value;
  const { tags = [] } = state.task ?? {};
  if (tags.length === 0 || isExperimenter(state)) return undefined;
  const half = Math.ceil(tags.length / 2);
  const columns = [tags.slice(0, half), tags.slice(half)];
  return (
    <div class="page-tags" aria-hidden="true">
      {columns.map((column, side) => (
        <div key={side === 0 ? "left" : "right"}>
          {column.map((pattern, row) => (
            <Tag key={pattern} pattern={pattern} id={side * half + row} />
          ))}
        </div>
      ))}
    </div>
  );
}

/** A white frame, a black one, and the 6 x 6 cells of the pattern. */
function Tag({ pattern, id }: { pattern: bigint; id: number }) {
  return (
    <svg viewBox="0 0 10 10" shape-rendering="crispEdges">
      <title>{`Tag ${id}`}</title>
      <rect width="10" height="10" fill="#fff" />
      <rect x="1" y="1" width="8" height="8" fill="#000" data-tag={id} />
      <path d={whiteCells(pattern)} fill="#fff" />
    </svg>
  );
}

/** The white cells of a pattern as an SVG path; the first cell is the highest of 36 bits. */
export function whiteCells(pattern: bigint): string {
  const cells: string[] = [];
  for (let at = 0; at < inner * inner; at += 1) {
    const isWhite = (pattern >> BigInt(inner * inner - 1 - at)) & 1n;
    if (isWhite) cells.push(`M${2 + (at % inner)} ${2 + Math.floor(at / inner)}h1v1h-1z`);
  }
  return cells.join("");
}
