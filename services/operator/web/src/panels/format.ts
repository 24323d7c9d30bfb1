// Formats of numbers in the panels.

const unknown = "–";

/** "0.4 s", "12 s", "3 min", "2 h". */
export function duration(seconds: number | undefined): string {
  if (seconds === undefined || !Number.isFinite(seconds)) return unknown;
  if (seconds < 9.95) return `${seconds.toFixed(1)} s`;
  if (seconds < 119.5) return `${Math.round(seconds)} s`;
  if (seconds < 7170) return `${Math.round(seconds / 60)} min`;
  return `${Math.round(seconds / 3600)} h`;
}

/** "45 ms", "1.2 s"; from s. */
export function milliseconds(seconds: number | undefined): string {
  if (seconds === undefined || !Number.isFinite(seconds)) return unknown;
  return seconds < 0.9995 ? `${Math.round(seconds * 1000)} ms` : duration(seconds);
}

/** "71 %", from a share of 1. */
export function percent(share: number | undefined): string {
  return share === undefined || !Number.isFinite(share) ? unknown : `${Math.round(share * 100)} %`;
}

/** A number, or a dash for 0, which means not measured yet. */
export function measured(value: number | undefined, digits = 1): string {
  return value === undefined || value === 0 || !Number.isFinite(value)
    ? unknown
    : value.toFixed(digits);
}

/** "1:05", "1:02:03". */
export function playTime(seconds: number): string {
  const whole = Math.max(0, Math.floor(seconds));
  const hours = Math.floor(whole / 3600);
  const two = (n: number) => String(n).padStart(2, "0");
  const minutes = Math.floor(whole / 60) % 60;
  return hours > 0
    ? `${hours}:${two(minutes)}:${two(whole % 60)}`
    : `${minutes}:${two(whole % 60)}`;
}

/** Time of day, from s since 1970. */
export function timeOfDay(seconds: number): string {
  return new Date(seconds * 1000).toLocaleTimeString([], { hour12: false });
}

/** "27 B", "10 kB". */
export function bytesText(bytes: number): string {
  return bytes < 1000 ? `${bytes} B` : `${(bytes / 1000).toFixed(bytes < 9950 ? 1 : 0)} kB`;
}

export function count(n: number, one: string, many = `${one}s`): string {
  return `${n} ${n === 1 ? one : many}`;
}
