import { useConsole } from "../../app/console";
import { RobotMark } from "../../app/robot_mark";
import { keyHint } from "../../app/shortcuts";
import type { AttentionItem } from "../../protocol/generated/console_pb";
import { isStopped, mayCommand, nameOf, runTime, waitingItems } from "../../state/selectors";
import { duration, measured } from "../format";
import { adviceText, emptyQueueText, patienceText, reasonText } from "./queue_texts";
import "./attention.css";

/** What robots wait for. */
export function Queue() {
  const { store, actions } = useConsole();
  const time = runTime(store.state.value, store.now.value);
  const items = waitingItems(store.state.value);
  const me = store.state.value.welcome?.client ?? "";
  const advised =
    items.find(({ selectedBy }) => selectedBy !== "" && selectedBy === me) ?? items[0];
  return (
    <section class="panel queue" aria-label="Attention queue" data-tour="queue" data-area="queue">
      <div class="row">
        <h2>Needs you ({items.length})</h2>
        <button
          type="button"
          class={`end ${items.length > 0 ? "main" : ""}`}
          onClick={() => void actions.next()}
        >
          Next <kbd>{keyHint("next")}</kbd>
        </button>
      </div>
      {items.length === 0 && (
        <p class="quiet">{emptyQueueText(store.state.value, store.link.value.state)}</p>
      )}
      {items.length > 0 && !store.linked.value && (
        <p class="quiet">Last known queue, before the connection was lost.</p>
      )}
      <ol>
        {items.map((item) => (
          <QueueItem
            key={`${item.robot} ${item.reason}`}
            item={item}
            now={time}
            advised={item === advised}
          />
        ))}
      </ol>
    </section>
  );
}

interface ItemProps {
  item: AttentionItem;
  /** The run's clock. */
  now: number;
  /** Shows advice on what to do. */
  advised: boolean;
}

function QueueItem({ item, now, advised }: ItemProps) {
  const { store, actions } = useConsole();
  const { robot, reason, since, selectedBy } = item;
  const state = store.state.value;
  const drives = state.session?.drives ?? false;
  const age = Math.max(0, now - since);
  const mine = selectedBy !== "" && selectedBy === state.welcome?.client;
  return (
    <li class={mine ? "mine" : ""}>
      <button
        type="button"
        onClick={() => void actions.select(item)}
        aria-current={mine ? "true" : undefined}
        title={`Value lost per second: ${measured(item.valueLostPerSecond, 2)}. Expected work: ${duration(item.expectedInteraction)}.`}
      >
        <RobotMark robot={robot} />
        <span>
          <strong>{robot}</strong> {reasonText(reason, drives)}
          <span class="quiet times">
            waiting {duration(age)}
            {!isStopped(state, robot) && patienceText(item, now)}
            {selectedBy !== "" &&
              ` · ${mine ? "you are" : `${nameOf(state, selectedBy)} is`} on it`}
          </span>
          {advised && mayCommand(state) && <span class="advice">{adviceText(reason, drives)}</span>}
        </span>
      </button>
    </li>
  );
}
