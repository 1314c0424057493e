// Gamepads. Browsers give that name to steering wheels, flight sticks and motion sensors too, and any of them may rest anywhere: an axis counts
// only once it has been seen at rest near its middle, and then from there; a button only once it has been seen let go.
// What its axes and buttons mean is kept for each kind of pad, by its name, and can be learned.

const REST_MS = 500; // an axis that has not moved for as long is at rest
const STILL = 0.04; // it may tremble by so much
const MIDDLE = 0.3; // farther off than this, what rests is a pedal or gravity, no stick
const DEAD = 0.12;
const LEARNED = 0.6; // an axis that goes so far from its rest is meant
const KEEP = "gapseeker.pads";

// What a pad can be used for; the numbers are those of the standard layout: left stick, A and B, start, the two shoulders.
export const USES = { steer: "steer", drive: "drive", stop: "stop", auto: "auto", previous: "mode before", next: "next mode" };
const USUAL = { steer: { axis: 0, sign: 1 }, drive: { axis: 1, sign: -1 }, stop: [0, 1], auto: [9], previous: [4], next: [5] };

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
  constructor(storage = globalThis.localStorage) {
    this.known = new Map(); // by place in the browser's list
    this.storage = storage;
    this.learning = null; // { name, use, done }
    try {
      this.kept = JSON.parse(storage?.getItem(KEEP) || "{}");
    } catch {
      this.kept = {};
    }
  }

  mapping(name) {
    return { ...USUAL, ...this.kept[name] };
  }

  // The next axis that is moved, or button that is pressed, on the pad of this name becomes this use. done() is called then.
  learn(name, use, done) {
    this.learning = { name, use, done };
  }

  forget(name) {
    delete this.kept[name];
    this.save();
  }

  save() {
    try {
      this.storage?.setItem(KEEP, JSON.stringify(this.kept));
    } catch {
      // it is known until the page is closed
    }
  }

  // { x, y, uses }: all pads' sum, right and ahead positive, and the names of what was pressed since the last time. now: ms.
  read(pads, now) {
    const found = { x: 0, y: 0, uses: [] };
    for (const [place, pad] of [...pads].entries()) {
      const name = pad?.connected === false ? null : pad?.id ?? (pad && "");
      if (this.known.get(place)?.name !== name) this.known.delete(place);
      if (name === null || name === undefined) continue;
      if (!this.known.has(place)) this.known.set(place, { name, axes: pad.axes.map((value) => new Axis(value, now)), held: pad.buttons.map(() => true) });
      const one = this.known.get(place);
      one.moved = pad.axes.map((value, k) => one.axes[k]?.read(value, now) ?? 0);
      const hits = [];
      one.pressed = pad.buttons.map(({ pressed }, k) => {
        if (pressed && !one.held[k]) hits.push(k);
        one.held[k] = pressed;
        return pressed;
      });
      if (this.learning?.name === name) {
        this.learned(one, hits);
        continue; // what is shown to it is no command
      }
      const map = this.mapping(name);
      found.x += (one.moved[map.steer.axis] || 0) * map.steer.sign;
      found.y += (one.moved[map.drive.axis] || 0) * map.drive.sign;
      for (const use of ["stop", "auto", "previous", "next"]) if (hits.some((k) => map[use].includes(k))) found.uses.push(use);
    }
    return found;
  }

  learned({ name, moved }, hits) {
    const { use, done } = this.learning;
    const axis = moved.findIndex((value) => Math.abs(value) > LEARNED);
    let what = null;
    // To the right, and ahead: that is how it is asked for.
    if (use === "steer" || use === "drive") what = axis < 0 ? null : { axis, sign: Math.sign(moved[axis]) };
    else if (hits.length) what = [hits[0]];
    if (!what) return;
    this.kept[name] = { ...this.kept[name], [use]: what };
    this.learning = null;
    this.save();
    done();
  }
}
