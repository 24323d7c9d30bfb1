import { useEffect, useRef, useState } from "preact/hooks";
import { useConsole } from "../../app/console";
import { storageOf, type TextStorage } from "../../connection/browser_storage";
import type { Outcome } from "../../map/map_props";
import type { Task } from "../../protocol/generated/console_pb";
import type { FormEvents, ShownForm } from "./survey";

/** ms after a change until the service gets the draft. */
const draftDelay = 400;

const tabStorage = storageOf(() => sessionStorage);

/** A form to fill in. What is filled in so far outlives page and service. */
export function FormStep({ task }: { task: Task }) {
  const { actions } = useConsole();
  const [outcome, setOutcome] = useState<Outcome | "sending">();
  const completed = useRef<object>({});
  const tab = draftOfTab(tabStorage, task);
  const drafts = useDrafts((json) => void tab.keepUntil(actions.draft(json), json));
  const send = async () => {
    drafts.forget();
    setOutcome("sending");
    const json = JSON.stringify(completed.current);
    setOutcome(await tab.keepUntil(actions.answers(json), json));
  };
  return (
    <>
      <SurveyForm
        task={task}
        events={{
          changed: drafts.change,
          completed: (answers) => {
            completed.current = answers;
            void send();
          },
        }}
      />
      {outcome === "sending" && <output class="quiet">Saving your answers…</output>}
      {typeof outcome === "object" && !outcome.accepted && (
        <p class="row form-problem" role="alert">
          Your answers are not saved yet: {outcome.reason}.
          <button type="button" class="main" onClick={() => void send()}>
            Send again
          </button>
        </p>
      )}
    </>
  );
}

interface Drafts {
  change(answers: object): void;
  forget(): void;
}

/** Sends a draft some time after a change, and at once when the page is left. */
function useDrafts(send: (json: string) => void): Drafts {
  const kept = useRef<{ drafts: Drafts; flush: () => void }>();
  kept.current ??= makeDrafts(send);
  const { drafts, flush } = kept.current;
  useEffect(() => {
    document.addEventListener("visibilitychange", flush);
    return () => {
      document.removeEventListener("visibilitychange", flush);
      flush();
    };
  }, [flush]);
  return drafts;
}

/** What the service may not have yet: the page may be reloaded while it is away. */
export function draftOfTab(storage: TextStorage, { participant, step }: Task) {
  const key = `conav.draft.${participant}.${step}`;
  return {
    read: () => storage.getItem(key) || undefined,
    async keepUntil(taken: Promise<Outcome>, json: string): Promise<Outcome> {
      storage.setItem(key, json);
      const outcome = await taken;
      if (outcome.accepted && storage.getItem(key) === json) storage.setItem(key, "");
      return outcome;
    },
  };
}

export function makeDrafts(send: (json: string) => void): { drafts: Drafts; flush: () => void } {
  let waiting: object | undefined;
  let timer: ReturnType<typeof setTimeout> | undefined;
  const forget = () => {
    clearTimeout(timer);
    timer = undefined;
    waiting = undefined;
  };
  const flush = () => {
    const answers = waiting;
    forget();
    if (answers !== undefined) send(JSON.stringify(answers));
  };
  const change = (answers: object) => {
    waiting = answers;
    timer ??= setTimeout(flush, draftDelay);
  };
  return { drafts: { change, forget }, flush };
}

/** The form of the step. Without `events` it is only read, and shows the draft as it grows. */
export function SurveyForm({ task, events }: { task: Task; events?: FormEvents }) {
  const { store } = useConsole();
  const { form, draft } = store.state.value;
  const place = useRef<HTMLDivElement>(null);
  const shown = useRef<ShownForm>();
  const newest = useRef(events);
  newest.current = events;
  const shownTask = useRef(task);
  shownTask.current = task;
  const [failed, setFailed] = useState(false);
  const isReady = draft !== undefined;
  const [json, reads, language] = [form?.json, events === undefined, task.language];
  useEffect(() => {
    const element = place.current;
    if (!isReady || json === undefined || element === null) return undefined;
    let ended = false;
    const kept = reads ? undefined : draftOfTab(tabStorage, shownTask.current).read();
    const answers = answersOf(kept ?? store.state.peek().draft?.json);
    const calls: FormEvents = {
      changed: (now) => newest.current?.changed(now),
      completed: (now) => newest.current?.completed(now),
    };
    import("./survey")
      .then(({ showForm }) => showForm(element, json, language, answers, reads ? undefined : calls))
      .then(
        (form) => {
          if (ended) form.close();
          else shown.current = form;
        },
        () => setFailed(true),
      );
    return () => {
      ended = true;
      shown.current?.close();
      shown.current = undefined;
    };
  }, [store, isReady, json, language, reads]);
  useEffect(() => {
    if (reads) shown.current?.show(answersOf(draft?.json));
  }, [reads, draft]);
  return (
    <>
      {failed && (
        <p role="alert">The form could not be loaded. Reload the page: your answers are kept.</p>
      )}
      <div ref={place} class="study-form" data-area="form" />
    </>
  );
}

/** Empty when there are none. */
export function answersOf(json: string | undefined): object {
  if (json === undefined || json === "") return {};
  const answers: unknown = JSON.parse(json);
  return typeof answers === "object" && answers !== null ? answers : {};
}
