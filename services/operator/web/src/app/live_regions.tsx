import type { Announcer } from "../panels/attention/announcer";

/** Announcements for screen readers. */
export function LiveRegions({ announcer }: { announcer: Announcer }) {
  return (
    <>
      <output class="unseen" aria-live="polite">
        {announcer.polite.value}
      </output>
      <div class="unseen" role="alert" aria-live="assertive">
        {announcer.urgent.value}
      </div>
    </>
  );
}
