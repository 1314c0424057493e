// The map from above: walls and the true place in the twin; otherwise the way the robot believes it has come.

import { line, polygon, prepare } from "./canvas.js";
import { bodyOf, carry, corners } from "./geometry.js";
import { cross } from "./marks.js";
import { colours, faded } from "./theme.js";
import { View } from "./view.js";

const TRACK = 4000; // places remembered
const RAD = Math.PI / 180;
const NEAR_PX = 9;
const BARS = [100, 200, 500, 1000, 2000, 5000, 10000]; // mm

export class WorldMap {
  // moved(box, done): a box is being dragged.
  constructor(canvas, state, redraw, tip, moved) {
    Object.assign(this, { canvas, state, tip, moved });
    this.clear();
    this.view = new View(canvas, redraw, {
      press: (point) => this.panels?.press({ ...point, robot: this.back(point) }),
      grab: (point) => this.grab(point),
      drag: (point, done) => this.moved({ ...this.state.box, x: point.x - this.held.x, y: point.y - this.held.y }, done),
    });
  }

  clear() {
    this.track = [];
    this.believed = [];
    this.pair = null; // a true place and the believed one of the same moment
    this.stops = []; // where it stopped while this page looked on: { x, y, text }
    this.last = null;
  }

  // Remember where it came to a stop, and why; called for each decision.
  stopped({ v }, text) {
    const place = this.state.truth || this.state.pose;
    if (v === 90 && this.last !== null && this.last !== 90 && place) this.stops.push({ x: place.x, y: place.y, text });
    this.last = v;
  }

  // Remember where it is; called for each message of a place.
  note(message) {
    if (message.type === "truth") {
      this.push(this.track, message);
    } else if (message.type === "pose") {
      this.push(this.believed, message);
      if (!this.pair && this.state.truth) this.pair = { truth: this.state.truth, pose: message };
    }
  }

  push(track, { x, y, heading }) {
    const last = track[track.length - 1];
    if (last && Math.hypot(x - last.x, y - last.y) < 5 && Math.abs(heading - last.heading) < 1) return;
    track.push({ x, y, heading });
    if (track.length > TRACK) track.shift();
  }

  // Places of the robot's own frame, in which it says where it is, and of the one that is drawn.
  there(p) {
    return this.state.truth && this.pair ? this.aligned(p) : p;
  }

  back(p) {
    if (!this.state.truth || !this.pair) return { x: p.x, y: p.y };
    const { truth, pose } = this.pair;
    const turn = (truth.heading - pose.heading) * RAD;
    const s = Math.sin(turn), c = Math.cos(turn), dx = p.x - truth.x, dy = p.y - truth.y;
    return { x: pose.x + dx * c - dy * s, y: pose.y + dx * s + dy * c };
  }

  // Where a believed place would be, had the robot erred nowhere since it was first seen here.
  aligned(p) {
    const { truth, pose } = this.pair;
    const turn = (truth.heading - pose.heading) * RAD;
    return carry({ x: p.x - pose.x, y: p.y - pose.y }, { x: truth.x, y: truth.y, heading: turn });
  }

  grab(point) {
    const { box } = this.state;
    if (!box?.size || Math.max(Math.abs(point.x - box.x), Math.abs(point.y - box.y)) > box.size / 2 + 8 / this.view.now.scale) return false;
    this.held = { x: point.x - box.x, y: point.y - box.y };
    return true;
  }

  // All of it: { scale, x, y }.
  whole(width, height, place) {
    const xs = [place.x - 500, place.x + 500], ys = [place.y - 500, place.y + 500];
    for (const [x1, y1, x2, y2] of this.state.world?.walls || []) {
      xs.push(x1, x2);
      ys.push(y1, y2);
    }
    for (const track of [this.state.truth ? this.track : this.believed, this.run?.track || [], this.other?.track || []]) {
      for (const p of track) {
        xs.push(p.x);
        ys.push(p.y);
      }
    }
    const [left, right, low, high] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    return { scale: Math.min(width / (right - left), height / (high - low)) * 0.94, x: (left + right) / 2, y: (low + high) / 2 };
  }

  draw() {
    const { pen, width, height } = prepare(this.canvas);
    const { truth, pose, hello, world, box, moving } = this.state;
    const body = bodyOf(hello);
    const place = truth || pose;
    if (!place) return;
    const { scale, x, y } = this.view.frame(width, height, this.whole(width, height, place), place);
    pen.translate(width / 2, height / 2);
    pen.scale(scale, -scale);
    pen.translate(-x, -y);
    this.pixel = 1 / scale;

    pen.lineCap = "round";
    pen.lineWidth = 3 * this.pixel;
    pen.strokeStyle = colours.wall;
    for (const [x1, y1, x2, y2] of world?.walls || []) line(pen, [{ x: x1, y: y1 }, { x: x2, y: y2 }]);
    for (const [x1, y1, x2, y2] of moving?.walls || []) line(pen, [{ x: x1, y: y1 }, { x: x2, y: y2 }]);
    if (box?.size) this.box(pen, box);
    this.tracks(pen, truth);
    if (this.other?.place) this.outline(pen, body, this.other.place, colours.other, false);
    this.outline(pen, body, place, colours.chosen, true);
    this.panels?.draw("drawWorld", pen, { pixel: this.pixel, fromRobot: (p) => this.there(p) });
    this.bar(pen, width, height);
    this.tell(place);
  }

  tracks(pen, truth) {
    const { run, other } = this;
    pen.lineWidth = 1.5 * this.pixel;
    if (run) {
      pen.strokeStyle = faded(colours.chosen, 0.45);
      line(pen, run.track);
    }
    for (const mark of run ? run.marks : this.stops) if (mark.x !== undefined) cross(pen, mark.x, mark.y, colours.edge, 4, this.pixel);
    if (other?.track?.length) {
      pen.strokeStyle = colours.other;
      pen.setLineDash([9 * this.pixel, 4 * this.pixel]);
      line(pen, other.track);
    }
    if (truth && this.pair) {
      pen.strokeStyle = colours.faint;
      pen.setLineDash([3 * this.pixel, 4 * this.pixel]);
      line(pen, this.believed.map((p) => this.aligned(p)));
    }
    pen.setLineDash([]);
    pen.lineWidth = 2 * this.pixel;
    pen.strokeStyle = colours.chosen;
    if (!run) line(pen, truth ? this.track : this.believed);
  }

  outline(pen, body, place, colour, full) {
    const at = { x: place.x, y: place.y, heading: place.heading * RAD };
    pen.lineWidth = 1.5 * this.pixel;
    pen.beginPath();
    polygon(pen, corners(body).map((p) => carry(p, at)));
    pen.fillStyle = faded(colour, 0.35);
    if (full) pen.fill();
    pen.strokeStyle = full ? colours.edge : colour;
    pen.stroke();
    const l = body.length / 2;
    pen.beginPath();
    polygon(pen, [{ x: 0, y: l - 12 }, { x: -60, y: l - 110 }, { x: 60, y: l - 110 }].map((p) => carry(p, at)));
    pen.fillStyle = full ? colours.edge : colour;
    pen.fill();
  }

  box(pen, { x, y, size }) {
    pen.fillStyle = faded(colours.wall, 0.35);
    pen.fillRect(x - size / 2, y - size / 2, size, size);
    pen.strokeRect(x - size / 2, y - size / 2, size, size);
  }

  // A length to compare with, in the corner.
  bar(pen, width, height) {
    const length = BARS.find((one) => one / this.pixel > 50) || BARS[BARS.length - 1], long = length / this.pixel;
    pen.setTransform(devicePixelRatio || 1, 0, 0, devicePixelRatio || 1, 0, 0);
    pen.strokeStyle = pen.fillStyle = colours.faint;
    pen.lineWidth = 2;
    line(pen, [{ x: 10, y: height - 14 }, { x: 10, y: height - 10 }, { x: 10 + long, y: height - 10 }, { x: 10 + long, y: height - 14 }]);
    pen.font = "11px system-ui, sans-serif";
    pen.fillText(length < 1000 ? `${length} mm` : `${length / 1000} m`, 14 + long, height - 8);
  }

  tell(place) {
    const { hover } = this.view;
    if (!hover) return this.tip("");
    const p = this.view.point(hover.x, hover.y);
    const stop = (this.run ? this.run.marks : this.stops).find(({ x, y }) => Math.hypot(x - p.x, y - p.y) < NEAR_PX * this.pixel);
    if (stop) return this.tip(`stopped here: ${stop.text}`, hover.x, hover.y);
    return this.tip(`x ${Math.round(p.x)} y ${Math.round(p.y)} mm, ${Math.round(Math.hypot(p.x - place.x, p.y - place.y))} mm from the robot's middle`, hover.x, hover.y);
  }
}
