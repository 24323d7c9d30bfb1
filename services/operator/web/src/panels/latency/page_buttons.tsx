import { useConsole } from "../../app/console";

/** How the page itself looks; the same as their keys. */
export function PageButtons() {
  const { store, commands } = useConsole();
  const { workload, events, theme } = store.settings.value;
  return (
    <span class="row page-buttons">
      <button type="button" aria-pressed={workload} onClick={commands.workload}>
        Workload
      </button>
      <button type="button" aria-pressed={events} onClick={commands.events}>
        Log
      </button>
      <button type="button" title="Dark, light, or as the system" onClick={commands.theme}>
        <span aria-hidden="true">◐ </span>
        <span class="unseen">Theme: </span>
        {theme}
      </button>
      <button type="button" onClick={commands.help} aria-label="Help: all keys">
        ?
      </button>
    </span>
  );
}
