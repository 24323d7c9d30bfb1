import { EventKind, type Mark, MarkKind } from "../../protocol/generated/console_pb";
import type { ConsoleState } from "../../state/console_state";
import { mark } from "../../state/history";

/** What happened in a run that goes on, as in the marks of a recording; positions are wall times of the service. */
export function liveMarks(
  { events, pictures, alerts }: Pick<ConsoleState, "events" | "pictures" | "alerts">,
  goals: readonly Mark[],
): readonly Mark[] {
  const marks = events.flatMap(({ kind, time, robot, text }) => {
    const of = kindOf(kind);
    return of === undefined ? [] : [mark(of, time, robot, text)];
  });
  for (const { robot, sequenceNumber, receivedAt } of [...pictures.values()].flat()) {
    marks.push(
      mark(MarkKind.MARK_SNAPSHOT, receivedAt, robot, `picture ${sequenceNumber} of ${robot}`),
    );
  }
  for (const { raised, source, text } of alerts) {
    marks.push(mark(MarkKind.MARK_ALERT, raised, source, text));
  }
  return [...marks, ...goals];
}

function kindOf(kind: EventKind): MarkKind | undefined {
  switch (kind) {
    case EventKind.EVENT_EDIT:
      return MarkKind.MARK_EDIT;
    case EventKind.EVENT_GUIDE:
    case EventKind.EVENT_ANSWER:
      return MarkKind.MARK_GUIDANCE;
    case EventKind.EVENT_NOTE:
      return MarkKind.MARK_NOTE;
    default:
      return undefined;
  }
}
