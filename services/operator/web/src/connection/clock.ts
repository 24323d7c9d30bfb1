export type Cancel = () => void;

/** The page's time, injected so that tests control it. */
export interface Clock {
  /** s, monotonic; not the time of day. */
  now(): number;
  /** In [0, 1). */
  random(): number;
  every(seconds: number, act: () => void): Cancel;
  after(seconds: number, act: () => void): Cancel;
}

export const pageClock: Clock = {
  now: () => performance.now() / 1000,
  random: () => Math.random(),
  every: (seconds, act) => {
    const timer = setInterval(act, seconds * 1000);
    return () => clearInterval(timer);
  },
  after: (seconds, act) => {
    const timer = setTimeout(act, seconds * 1000);
    return () => clearTimeout(timer);
  },
};
