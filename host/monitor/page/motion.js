// Where things are by now that were seen a moment ago: points come a few times a second, the robot's own motion twenty times.

import { carry } from "./geometry.js";

const WRAP = 2 ** 30 / 1e6; // the robot's clock starts over after this, s
const SPAN = 1.5; // s remembered

function since(time, earlier) {
  return ((time - earlier) % WRAP + 1.5 * WRAP) % WRAP - WRAP / 2;
}

export class Motion {
  constructor() {
    this.clear();
  }

  clear() {
    this.poses = [];
  }

  note({ time, x, y, heading }) {
    const last = this.poses[this.poses.length - 1];
    if (last && !(since(time, last.time) > 0)) this.clear();
    this.poses.push({ time, x, y, heading: heading * Math.PI / 180 });
    while (since(time, this.poses[0].time) > SPAN) this.poses.shift();
  }

  // Callable (x, y) -> { x, y }: from the body frame of that time, s, to the one of now.
  from(time) {
    const now = this.poses[this.poses.length - 1];
    const then = this.at(time);
    if (!now || !then) return (x, y) => ({ x, y });
    const s = Math.sin(now.heading), c = Math.cos(now.heading);
    return (x, y) => {
      const p = carry({ x, y }, then);
      const dx = p.x - now.x, dy = p.y - now.y;
      return { x: dx * c - dy * s, y: dx * s + dy * c };
    };
  }

  // The pose at a time, between the two told before and after it; null when that is too long ago.
  at(time) {
    const after = this.poses.findIndex((pose) => since(pose.time, time) >= 0);
    if (after < 0) return this.poses[this.poses.length - 1] || null;
    if (after === 0) return since(this.poses[0].time, time) < 0.1 ? this.poses[0] : null;
    const a = this.poses[after - 1], b = this.poses[after];
    const part = since(time, a.time) / since(b.time, a.time);
    const turn = Math.atan2(Math.sin(b.heading - a.heading), Math.cos(b.heading - a.heading));
    return { x: a.x + (b.x - a.x) * part, y: a.y + (b.y - a.y) * part, heading: a.heading + turn * part };
  }
}
