/** A moment of a run in an address: "#run=20261126-101010-seed1&moment=1764150000.5". */
export interface LinkedMoment {
  readonly run: string;
  /** Wall time of the service, s since 1970. */
  readonly time: number;
}

export function linkTo(address: string, run: string, time: number): string {
  const url = new URL(address);
  url.hash = new URLSearchParams({ run, moment: time.toFixed(1) }).toString();
  return url.href;
}

/** `hash`: of the page's address. */
export function momentOf(hash: string): LinkedMoment | undefined {
  const given = new URLSearchParams(hash.replace(/^#/, ""));
  const time = Number(given.get("moment") ?? Number.NaN);
  return Number.isFinite(time) ? { run: given.get("run") ?? "", time } : undefined;
}
