// The map round the robot, its nose up: what it sees, what it means to do, and what stops it.

import { line, polygon, prepare } from "./canvas.js";
import { Candidates } from "./candidates.js";
import { bodyOf, carry, corners, pose, sweep, twist, wheels, zones } from "./geometry.js";
import { Memory, OLD_S } from "./memory.js";
import { WINDOWS, cross, mark } from "./marks.js";
import { colours, faded } from "./theme.js";
import { View } from "./view.js";

const RINGS = [500, 1000, 1500, 2000];
const NEAR_PX = 9;

export class RobotMap {
  // tip(text or "", x, y): words beside the pointer.
  constructor(canvas, state, motion, redraw, tip) {
    Object.assign(this, { canvas, state, motion, tip, candidates: new Candidates(state), memory: new Memory(), shown: { ages: false } });
    this.view = new View(canvas, redraw);
  }

  clear() {
    this.memory.clear();
  }

  note(points) {
    this.memory.note(points, this.motion.at(points.time));
  }

  draw() {
    const { pen, width, height } = prepare(this.canvas);
    const { state } = this;
    const body = bodyOf(state.hello);
    const ahead = state.parameter("windows.look_ahead", 700);
    // All that the planning window holds, whichever way it looks, and a little more.
    const whole = Math.min(width / (2 * Math.max(body.width / 2 + 520, 600)), height / (body.length + 2 * ahead * 0.9));
    const { scale, x, y } = this.view.frame(width, height, { scale: whole, x: 0, y: 0 }, { x: 0, y: 0 });
    pen.translate(width / 2, height / 2);
    pen.scale(scale, -scale);
    pen.translate(-x, -y);
    this.pixel = 1 / scale;
    this.seen = this.now(state.points);
    const pointer = this.view.hover && this.view.point(this.view.hover.x, this.view.hover.y);
    // Standing, it has refused nothing: what it found the last time it looked is of then.
    this.candidates.judge(body, ahead, this.seen);
    const moves = (state.decision?.v ?? 90) !== 90;
    const pointed = moves && pointer ? this.candidates.at(pointer, this.pixel) : null;

    this.rings(pen);
    this.margins(pen, body, ahead);
    this.zones(pen, body);
    if (moves) this.candidates.draw(pen, this.pixel, this.seen, pointed);
    this.envelope(pen, body, ahead);
    this.points(pen);
    this.body(pen, body);
    this.block(pen);
    this.panels?.draw("drawRobot", pen, { pixel: this.pixel });
    this.tell(pointer, pointed, body);
  }

  // What lies under the pointer, in words.
  tell(pointer, pointed, body) {
    if (!pointer) return this.tip("");
    const point = this.nearest(pointer);
    const off = Math.hypot(Math.max(Math.abs(pointer.x) - body.width / 2, 0), Math.max(Math.abs(pointer.y) - body.length / 2, 0));
    let text = `${Math.round(off)} mm from the body`;
    if (point >= 0) {
      const age = this.memory.ages[point];
      text = `${WINDOWS[this.seen.window[point]]}, ${text}${age === undefined ? "" : `, remembered for ${age.toFixed(1)} s`}`;
    } else if (pointed) {
      text = this.candidates.words(pointed, this.seen, body);
    }
    return this.tip(text, this.view.hover.x, this.view.hover.y);
  }

  nearest(pointer) {
    let best = -1, least = NEAR_PX * this.pixel;
    this.seen?.x.forEach((x, i) => {
      const d = Math.hypot(x - pointer.x, this.seen.y[i] - pointer.y);
      if (d < least) [best, least] = [i, d];
    });
    return best;
  }

  // The points as the robot would see them from where it is now.
  now(points) {
    if (!points) return null;
    const shift = this.motion.from(points.time);
    const places = points.x.map((x, i) => shift(x, points.y[i]));
    return { x: places.map((p) => p.x), y: places.map((p) => p.y), window: points.window };
  }

  rings(pen) {
    pen.lineWidth = this.pixel;
    pen.strokeStyle = colours.faintLine;
    for (const radius of RINGS) {
      pen.beginPath();
      pen.arc(0, 0, radius, 0, 2 * Math.PI);
      pen.stroke();
      this.text(pen, `${radius / 1000} m`, radius * Math.SQRT1_2, -radius * Math.SQRT1_2);
    }
  }

  text(pen, text, x, y) {
    pen.save();
    pen.translate(x, y);
    pen.scale(this.pixel, -this.pixel);
    pen.font = "11px system-ui, sans-serif";
    pen.fillStyle = colours.faint;
    pen.fillText(text, 3, 3);
    pen.restore();
  }

  margins(pen, body, ahead) {
    const w = body.width / 2, l = body.length / 2;
    const frame = (margin, colour) => {
      pen.strokeStyle = colour;
      pen.strokeRect(-w - margin, -l - margin, body.width + 2 * margin, body.length + 2 * margin);
    };
    pen.lineWidth = this.pixel;
    frame(this.state.parameter("windows.red", 20), faded(colours.red, 0.5));
    frame(this.state.parameter("windows.blue", 45), faded(colours.blue, 0.5));
    const side = this.state.parameter("windows.side", 300);
    const back = (this.state.decision?.v ?? 90) < 90;
    pen.setLineDash([8 * this.pixel, 6 * this.pixel]);
    pen.strokeStyle = faded(colours.yellow, 0.45);
    pen.strokeRect(-w - side, back ? -l - ahead : -l, body.width + 2 * side, body.length + ahead);
    pen.setLineDash([]);
  }

  zones(pen, body) {
    const { decision } = this.state;
    zones(body, Math.max(this.state.parameter("windows.blue", 45), 40)).forEach((zone, number) => {
      pen.beginPath();
      polygon(pen, zone);
      if (decision && decision.zone === number) {
        pen.fillStyle = faded(colours.windows[decision.window], 0.6);
        pen.fill();
      }
      pen.strokeStyle = colours.faintLine;
      pen.stroke();
    });
  }

  way(decision, ahead) {
    if (!decision || decision.v === 90) return 0;
    return (decision.v < 90 ? -1 : 1) * Math.min(Math.max(decision.free, 40), ahead);
  }

  envelope(pen, body, ahead) {
    const { decision } = this.state;
    const distance = this.way(decision, ahead);
    if (!distance) return;
    pen.beginPath();
    for (const outline of sweep(body, decision.af, decision.ar, distance)) polygon(pen, outline);
    pen.fillStyle = faded(colours.chosen, 0.16);
    pen.fill("nonzero");
    // Tracks of the corners: paper A, equation 18, as corrected.
    const t = twist(body, decision.af, decision.ar);
    pen.lineWidth = 1.5 * this.pixel;
    pen.strokeStyle = colours.chosen;
    for (const corner of corners(body)) {
      line(pen, Array.from({ length: 25 }, (_, i) => carry(corner, pose(t, distance * i / 24))));
    }
  }

  points(pen) {
    const { scan } = this.state;
    if (scan) {
      pen.fillStyle = faded(colours.text, 0.3);
      const shift = this.motion.from(scan.times[scan.times.length - 1]), size = 3 * this.pixel;
      scan.distances.forEach((distance, i) => {
        if (!distance) return;
        const bearing = scan.bearings[i] * Math.PI / 180;
        const p = shift(distance * Math.sin(bearing), distance * Math.cos(bearing));
        pen.fillRect(p.x - size / 2, p.y - size / 2, size, size);
      });
    }
    const { ages } = this.memory;
    this.seen?.x.forEach((x, i) => {
      mark(pen, x, this.seen.y[i], this.pixel, this.seen.window[i], this.shown.ages ? Math.min((ages[i] || 0) / OLD_S, 1) : 0);
    });
  }

  body(pen, body) {
    const w = body.width / 2, l = body.length / 2;
    pen.fillStyle = faded(colours.body, 0.9);
    pen.strokeStyle = colours.edge;
    pen.lineWidth = 2 * this.pixel;
    pen.beginPath();
    pen.roundRect(-w, -l, body.width, body.length, 20);
    pen.fill();
    pen.stroke();
    pen.beginPath();
    polygon(pen, [{ x: 0, y: l - 12 }, { x: -26, y: l - 52 }, { x: 26, y: l - 52 }]);
    pen.fillStyle = faded(colours.edge, 0.4);
    pen.fill();
    const now = this.state.wheels;
    wheels(body).forEach((p, k) => {
      const angle = now?.angles[k] ?? 0, speed = now?.speeds[k] ?? 0;
      pen.save();
      pen.translate(p.x, p.y);
      pen.rotate(-angle * Math.PI / 180);
      pen.fillStyle = colours.edge;
      pen.beginPath();
      pen.roundRect(-11, -30, 22, 60, 6);
      pen.fill();
      // An arrow the way it rolls.
      if (Math.abs(speed) >= 3) {
        const tip = Math.sign(speed) * 40;
        pen.beginPath();
        polygon(pen, [{ x: 0, y: tip }, { x: -13, y: tip / 2 }, { x: 13, y: tip / 2 }]);
        pen.fillStyle = colours.chosen;
        pen.fill();
      }
      pen.restore();
    });
    const lidar = body.lidar || [0, 0];
    pen.beginPath();
    pen.arc(lidar[0], lidar[1], 22, 0, 2 * Math.PI);
    pen.fillStyle = this.state.health?.lidar_ok === false ? colours.red : colours.edge;
    pen.fill();
  }

  block(pen) {
    const { decision } = this.state;
    if (!decision?.block) return;
    const { x, y } = this.motion.from(decision.time)(...decision.block);
    cross(pen, x, y, colours.red, 5, this.pixel);
    pen.beginPath();
    pen.arc(x, y, 11 * this.pixel, 0, 2 * Math.PI);
    pen.stroke();
  }
}
