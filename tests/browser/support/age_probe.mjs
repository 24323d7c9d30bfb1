import { fittedGrid } from "./fitted_grid.mjs";

/**
 * Measures the age of the robots on a page's map from what the map draws. Each robot drives eastwards at a known speed and starts
 * over in the west, so its position tells when its state was sent. The page itself is not involved.
 *
 * Age: from sending the state until the animation frame after the one in which the map drew it, when the drawing has reached the
 * compositor. `drawn` is the time of the drawing itself.
 *
 * @typedef {{ begin: number, west: number, speed: number, period: number, cellSize: number, rows: number, columns: number }} Drive
 *   begin: wall time in s; west: x in m where a period (s) starts; speed in m/s
 * @param {Drive} drive
 * @returns {string} a script for the page; afterwards `conavAges.take()` there returns the ages since the previous call
 */
export function ageProbe(drive) {
  return `(${probe})(${fittedGrid}, ${JSON.stringify(drive)})`;
}

/** Runs in the page. */
function probe(fitted, drive) {
  const grain = 10; // ms between two looks at what is on screen
  const wall = () => (performance.timeOrigin + performance.now()) / 1000;
  /** By robot: newest drawn x, x on screen, and since when it is on screen. */
  const robots = new Map();
  let canvas;
  let drawnAt = 0;
  let pending = false;
  let taken = {};

  /** Position of the grid; computed once per frame, because it forces a layout. */
  let place;
  const fresh = () => ({ shown: [], drawn: [], any: [], frames: 0, since: performance.now() });
  const ageAt = (x, now) => {
    const metres = ((x - place.left) / place.scale - drive.columns / 2) * drive.cellSize;
    const sent = (metres - drive.west) / drive.speed;
    const age = (now - drive.begin - sent) % drive.period;
    // One machine, one clock: a negative age is a bug and must be visible.
    return 1000 * (age > drive.period / 2 ? age - drive.period : age);
  };
  const show = () => {
    pending = false;
    taken.frames += 1;
    place = fitted({ width: canvas.clientWidth, height: canvas.clientHeight }, drive);
    const now = wall();
    for (const robot of robots.values()) {
      if (robot.x === robot.shownX) continue;
      if (robot.shownX !== undefined) look(robot, now);
      robot.shownX = robot.x;
      robot.since = now;
      taken.shown.push(ageAt(robot.x, now));
      taken.drawn.push(ageAt(robot.x, drawnAt));
    }
  };
  const look = (robot, now) => {
    for (let at = robot.since; at < now; at += grain / 1000)
      taken.any.push(ageAt(robot.shownX, at));
  };

  const { fillText } = CanvasRenderingContext2D.prototype;
  CanvasRenderingContext2D.prototype.fillText = function (text, x, ...more) {
    // A robot's letter.
    if (/^[A-Z]$/.test(text) && this.canvas.getAttribute("role") === "application") {
      canvas = this.canvas;
      const robot = robots.get(text) ?? {};
      robot.x = x;
      robots.set(text, robot);
      if (!pending) {
        pending = true;
        drawnAt = wall();
        requestAnimationFrame(show);
      }
    }
    return fillText.call(this, text, x, ...more);
  };
  taken = fresh();
  globalThis.conavAges = {
    take() {
      const now = wall();
      for (const robot of robots.values()) {
        if (robot.shownX === undefined) continue;
        look(robot, now);
        robot.since = now;
      }
      const { since, ...ages } = taken;
      taken = fresh();
      const rounded = (values) => values.map((value) => Math.round(10 * value) / 10);
      return {
        shown: rounded(ages.shown),
        drawn: rounded(ages.drawn),
        any: rounded(ages.any),
        frames: ages.frames,
        seconds: (taken.since - since) / 1000,
        robots: robots.size,
      };
    },
  };
}
