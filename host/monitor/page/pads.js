// Gamepads. Browsers give that name to steering wheels, flight sticks and motion sensors too, and any of them may rest anywhere: an axis counts
// only once it has been seen at rest near its middle, and then from there; a button only once it has been seen let go.

const REST_MS = 500; // an axis that has not moved for as long is at rest
const STILL = 0.04; // it may tremble by so much
const MIDDLE = 0.3; // farther off than this, what rests is a pedal or gravity, no stick
const DEAD = 0.12;

class Axis {
  constructor(value, now) {
    Object.assign(this, { value, since: now, rest: null });
  }

  // -1..1 from where it rests; 0 until that is known.
  read(value, now) {
    if (Math.abs(value - this.value) > STILL) Object.assign(this, { value, since: now });
    if (this.rest === null && now - this.since >= REST_MS && Math.abs(value) < MIDDLE) this.rest = value;
    const moved = this.rest === null ? 0 : value - this.rest;
    return Math.abs(moved) < DEAD ? 0 : Math.max(-1, Math.min(1, moved));
  }
}

export class Pads {
  constructor() {
    this.known = new Map(); // by place in the browser's list
  }

  // { x, y, hits }: both sticks' sum, right and ahead positive, and the numbers of the buttons pressed since the last time. now: ms.
  read(pads, now) {
    const found = { x: 0, y: 0, hits: [] };
    for (const [place, pad] of [...pads].entries()) {
      const name = pad?.connected === false ? null : pad?.id ?? (pad && "");
      if (this.known.get(place)?.name !== name) this.known.delete(place);
      if (name === null || name === undefined) continue;
      if (!this.known.has(place)) this.known.set(place, { name, axes: [0, 1].map((k) => new Axis(pad.axes[k] || 0, now)), held: pad.buttons.map(() => true) });
      const { axes, held } = this.known.get(place);
      found.x += axes[0].read(pad.axes[0] || 0, now);
      found.y -= axes[1].read(pad.axes[1] || 0, now);
      pad.buttons.forEach(({ pressed }, k) => {
        if (pressed && !held[k]) found.hits.push(k);
        held[k] = pressed;
      });
    }
    return found;
  }
}
