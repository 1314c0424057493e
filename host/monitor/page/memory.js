// For how long each point has been remembered: the robot tells its points without their age, so their places on the floor are compared.

import { carry } from "./geometry.js";

const CELL = 40; // mm; a remembered point moves by less as it is averaged
const GONE_S = 1.5; // a place that has not been told for so long begins anew
export const OLD_S = 8;

export class Memory {
  constructor() {
    this.clear();
  }

  clear() {
    this.places = new Map();
    this.ages = [];
  }

  // points: a message; at: the pose then ({ x, y, heading in rad }), null if it is not known.
  note(points, at) {
    if (!at) {
      this.ages = [];
      return;
    }
    const now = points.time;
    const keys = points.x.map((x, i) => {
      const p = carry({ x, y: points.y[i] }, at);
      return [Math.round(p.x / CELL), Math.round(p.y / CELL)];
    });
    for (const key of keys) {
      const place = this.places.get(String(key));
      if (place) place.last = now;
    }
    this.ages = keys.map((key) => Math.max(0, now - this.find(key, now).first));
    for (const [key, { last }] of this.places) if (now - last > GONE_S || last > now) this.places.delete(key);
  }

  // A place not known yet is new, unless the point of a neighbour, which is told no more, has crept over the border.
  find(key, now) {
    const [cx, cy] = key;
    let place = this.places.get(String(key));
    if (!place) {
      let first = now;
      for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
        const other = this.places.get(String([cx + dx, cy + dy]));
        if (other && other.last < now) first = Math.min(first, other.first);
      }
      place = { first, last: now };
      this.places.set(String(key), place);
    }
    return place;
  }
}
