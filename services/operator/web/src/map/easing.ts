import type { MapRobot } from "./map_props";

interface Pose {
  readonly x: number;
  readonly y: number;
  readonly heading: number;
}

/** A robot on its way from where it was drawn to its newest report. */
interface Glide {
  readonly report: MapRobot["robot"];
  readonly from: Pose;
  readonly begins: number; // s
  readonly takes: number; // s; 0 = it is there
}

/** Reports that come faster than this need no easing; after a longer silence a robot jumps. s */
const shortest = 0.08;
const longest = 0.5;
/** A robot that is farther from its last report was moved, it did not drive. m */
const farthest = 3;

/** Robots glide from report to report, in the time between the last two. */
export class Easing {
  #glides = new Map<string, Glide>();

  /** The robots as they are drawn at `now` (s), and whether any of them glides on. */
  at(
    robots: readonly MapRobot[],
    now: number,
  ): { readonly robots: readonly MapRobot[]; readonly moving: boolean } {
    let moving = false;
    const drawn = robots.map((one) => {
      const glide = this.#glideOf(one.robot, now);
      this.#glides.set(one.robot.name, glide);
      const share = glide.takes === 0 ? 1 : Math.min(1, (now - glide.begins) / glide.takes);
      if (share >= 1) return one;
      moving = true;
      return { ...one, robot: { ...one.robot, ...between(glide.from, one.robot, share) } };
    });
    return { robots: moving ? drawn : robots, moving };
  }

  #glideOf(report: MapRobot["robot"], now: number): Glide {
    const known = this.#glides.get(report.name);
    if (known?.report === report) return known;
    const from = known && poseAt(known, now);
    const since = known ? now - known.begins : 0;
    const drives = from && Math.hypot(report.x - from.x, report.y - from.y) <= farthest;
    const eases = drives && since >= shortest && since <= longest;
    return { report, from: from ?? report, begins: now, takes: eases ? since : 0 };
  }
}

function poseAt({ report, from, begins, takes }: Glide, now: number): Pose {
  const share = takes === 0 ? 1 : Math.min(1, (now - begins) / takes);
  return between(from, report, share);
}

function between(from: Pose, to: Pose, share: number): Pose {
  const turn = Math.atan2(Math.sin(to.heading - from.heading), Math.cos(to.heading - from.heading));
  return {
    x: from.x + share * (to.x - from.x),
    y: from.y + share * (to.y - from.y),
    heading: from.heading + share * turn,
  };
}
