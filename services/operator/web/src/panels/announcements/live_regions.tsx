import type { Announcer } from "./announcer";

/** For screen readers: what came up. */
export function LiveRegions({ announcer }: { announcer: Announcer }) {
  return (
    <>
      <div class="unseen" role="status" aria-live="polite">
        {announcer.polite.value}
      </div>
      <div class="unseen" role="alert" aria-live="assertive">
        {announcer.urgent.value}
      </div>
    </>
  );
}
