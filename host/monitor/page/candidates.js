// The steerings that were not chosen: their tracks, what ends them, and why each was refused.

import { line } from "./canvas.js";
import { carry, corners, firstHit, pose, twist } from "./geometry.js";
import { cross } from "./marks.js";
import { colours, faded } from "./theme.js";

const NEAR_PX = 12; // from the pointer to a track

export class Candidates {
  constructor(state) {
    this.state = state;
    this.ways = [];
  }

  // The candidates as the points allow them by now: what was found out about them is some moments old.
  judge(body, ahead, seen) {
    const { candidates, points } = this.state;
    if (this.from && this.from.candidates === candidates && this.from.points === points) return;
    this.from = { candidates, points };
    const margin = this.state.parameter("avoid.margin", 9);
    this.ways = [];
    for (const { list, backward } of Object.values(candidates || {})) {
      for (const one of list) {
        if (one.chosen) continue;
        const t = twist(body, one.af, one.ar);
        const told = one.free ?? ahead; // not looked at: the points tell all the same
        const free = Math.min(told, ahead) * (backward ? -1 : 1);
        const further = told >= ahead ? 0 : 60;
        const hit = seen ? firstHit(body, t, free, seen, margin - 3, 30, further) : { way: free, point: -1 };
        const lead = corners(body).slice(...(backward ? [2, 4] : [0, 2]));
        const tracks = lead.map((corner) => Array.from({ length: 9 }, (_, i) => carry(corner, pose(t, hit.way * i / 8))));
        this.ways.push({ ...one, t, backward, ...hit, tracks });
      }
    }
  }

  draw(pen, pixel, seen, pointed) {
    for (const one of this.ways) {
      const marked = one === pointed;
      pen.lineWidth = (marked ? 2.5 : 1) * pixel;
      pen.strokeStyle = marked ? colours.refused : faded(colours.refused, 0.25);
      for (const track of one.tracks) line(pen, track);
      if (one.point >= 0 && seen) cross(pen, seen.x[one.point], seen.y[one.point], faded(colours.refused, marked ? 1 : 0.7), marked ? 6 : 3, pixel);
    }
  }

  // The one whose track passes nearest to a place, within a few pixels; or null.
  at(place, pixel) {
    let best = null, least = NEAR_PX * pixel;
    for (const one of this.ways) {
      for (const track of one.tracks) {
        for (let i = 1; i < track.length; i++) {
          const d = distance(place, track[i - 1], track[i]);
          if (d < least) [best, least] = [one, d];
        }
      }
    }
    return best;
  }

  // Why this one was refused, in words. point: what ends it, { x, y }; window: its window's name.
  words({ af, ar, backward, free, way, point, t }, seen, body) {
    const name = `AF ${af}°, AR ${ar}°, ${backward ? "backward" : "ahead"}`;
    if (point >= 0 && seen) {
      const at = pose(t, way), dx = seen.x[point] - at.x, dy = seen.y[point] - at.y;
      const s = Math.sin(at.heading), c = Math.cos(at.heading);
      const told = free === null ? "not looked at, as others promised more; it would end" : "ends";
      return `${name}: ${told} after ${Math.round(Math.abs(way))} mm, where ${side(dx * c - dy * s, dx * s + dy * c, body)} comes within the margin of a point`;
    }
    if (free === null) return `${name}: not looked at, as others promised more`;
    return `${name}: free for ${Math.round(Math.abs(free))} mm, but its end costs more to leave from than that of the chosen one`;
  }
}

// Which part of the body is nearest to a place of its frame.
function side(x, y, body) {
  const across = x < 0 ? "left" : "right", along = y > 0 ? "front" : "rear";
  const out = Math.abs(x) - body.width / 2, ahead = Math.abs(y) - body.length / 2;
  if (out > -30 && ahead > -30) return `the ${across} ${along} corner`;
  return out > ahead ? `the ${across} side` : `the ${along} end`;
}

function distance(p, a, b) {
  const dx = b.x - a.x, dy = b.y - a.y;
  const along = Math.min(1, Math.max(0, ((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(p.x - a.x - along * dx, p.y - a.y - along * dy);
}
