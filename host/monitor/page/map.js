// The map, head up: what the robot sees, what it means to do, and what stops it.

import { line, polygon, prepare } from "./canvas.js";
import { bodyOf, carry, corners, firstHit, pose, sweep, twist, wheels, zones } from "./geometry.js";
import { colours, faded } from "./theme.js";

export class HeadUp {
  constructor(canvas, state, motion) {
    this.canvas = canvas;
    this.state = state;
    this.motion = motion;
  }

  draw() {
    const { pen, width, height } = prepare(this.canvas);
    const { state } = this;
    const body = bodyOf(state.hello);
    const ahead = state.parameter("windows.look_ahead", 700);
    // All that the planning window holds, whichever way it looks, and a little more.
    const scale = Math.min(width / (2 * Math.max(body.width / 2 + 520, 600)), height / (body.length + 2 * ahead * 0.9));
    pen.translate(width / 2, height / 2);
    pen.scale(scale, -scale);
    this.pixel = 1 / scale;
    this.seen = this.now(state.points);

    this.rings(pen);
    this.margins(pen, body, ahead);
    this.zones(pen, body);
    this.rejected(pen, body, ahead);
    this.envelope(pen, body, ahead);
    this.points(pen);
    this.body(pen, body);
    this.block(pen);
    this.panels?.draw("drawRobot", pen, { pixel: this.pixel });
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
    for (const radius of [500, 1000, 1500]) {
      pen.beginPath();
      pen.arc(0, 0, radius, 0, 2 * Math.PI);
      pen.stroke();
    }
  }

  margins(pen, body, ahead) {
    const w = body.width / 2, l = body.length / 2;
    const frame = (margin, colour) => {
      pen.strokeStyle = colour;
      pen.strokeRect(-w - margin, -l - margin, body.width + 2 * margin, body.length + 2 * margin);
    };
    pen.lineWidth = this.pixel;
    frame(this.state.parameter("windows.red", 20), faded(colours.red, .4));
    frame(this.state.parameter("windows.blue", 45), faded(colours.blue, .4));
    const side = this.state.parameter("windows.side", 300);
    const back = (this.state.decision?.v ?? 90) < 90;
    pen.setLineDash([8 * this.pixel, 6 * this.pixel]);
    pen.strokeStyle = faded(colours.yellow, .4);
    pen.strokeRect(-w - side, back ? -l - ahead : -l, body.width + 2 * side, body.length + ahead);
    pen.setLineDash([]);
  }

  zones(pen, body) {
    const { decision } = this.state;
    zones(body, Math.max(this.state.parameter("windows.blue", 45), 40)).forEach((zone, number) => {
      const acts = decision && decision.zone === number;
      pen.beginPath();
      polygon(pen, zone);
      pen.fillStyle = acts ? faded(colours.windows[decision.window], .6) : "transparent";
      pen.fill();
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
    pen.fillStyle = faded(colours.chosen, .16);
    pen.fill("nonzero");
    // Tracks of the corners: paper A, equation 18, as corrected.
    const t = twist(body, decision.af, decision.ar);
    pen.lineWidth = 1.5 * this.pixel;
    pen.strokeStyle = colours.chosen;
    for (const corner of corners(body)) {
      line(pen, Array.from({ length: 25 }, (_, i) => carry(corner, pose(t, distance * i / 24))));
    }
  }

  rejected(pen, body, ahead) {
    const { candidates, points } = this.state;
    if (!this.judged || this.judged.candidates !== candidates || this.judged.points !== points) this.judged = { candidates, points, ways: this.judge(body, ahead) };
    for (const { t, way, backward, point } of this.judged.ways) {
      const lead = corners(body).slice(...(backward ? [2, 4] : [0, 2]));
      pen.lineWidth = this.pixel;
      pen.strokeStyle = faded(colours.refused, .25);
      for (const corner of lead) line(pen, Array.from({ length: 9 }, (_, i) => carry(corner, pose(t, way * i / 8))));
      if (point >= 0 && this.seen) this.cross(pen, [this.seen.x[point], this.seen.y[point]], faded(colours.refused, .7), 3);
    }
  }

  // The candidates as the points allow them by now: what was found out about them is some moments old.
  judge(body, ahead) {
    const margin = this.state.parameter("avoid.margin", 9);
    const ways = [];
    for (const { list, backward } of Object.values(this.state.candidates || {})) {
      for (const one of list) {
        if (one.chosen) continue;
        const t = twist(body, one.af, one.ar);
        const told = one.free ?? ahead; // not looked at: the points tell all the same
        const free = Math.min(told, ahead) * (backward ? -1 : 1);
        const further = told >= ahead ? 0 : 60;
        ways.push({ t, backward, ...(this.seen ? firstHit(body, t, free, this.seen, margin - 3, 30, further) : { way: free, point: -1 }) });
      }
    }
    return ways;
  }

  points(pen) {
    const { scan } = this.state;
    const points = this.seen;
    const dot = (x, y, size) => pen.fillRect(x - size / 2, y - size / 2, size, size);
    if (scan) {
      pen.fillStyle = faded(colours.text, .25);
      const shift = this.motion.from(scan.times[scan.times.length - 1]);
      scan.distances.forEach((distance, i) => {
        if (!distance) return;
        const bearing = scan.bearings[i] * Math.PI / 180;
        const p = shift(distance * Math.sin(bearing), distance * Math.cos(bearing));
        dot(p.x, p.y, 3 * this.pixel);
      });
    }
    if (!points) return;
    points.x.forEach((x, i) => {
      const kind = points.window[i];
      pen.fillStyle = kind ? colours.windows[kind] : faded(colours.faint, .5);
      dot(x, points.y[i], (kind ? 5 : 3) * this.pixel);
    });
  }

  body(pen, body) {
    const w = body.width / 2, l = body.length / 2;
    pen.fillStyle = faded(colours.body, .9);
    pen.strokeStyle = colours.edge;
    pen.lineWidth = 2 * this.pixel;
    pen.beginPath();
    pen.roundRect(-w, -l, body.width, body.length, 20);
    pen.fill();
    pen.stroke();
    pen.beginPath();
    polygon(pen, [{ x: 0, y: l - 12 }, { x: -26, y: l - 52 }, { x: 26, y: l - 52 }]);
    pen.fillStyle = faded(colours.edge, .4);
    pen.fill();
    const now = this.state.wheels;
    wheels(body).forEach((p, k) => {
      const angle = now?.angles[k] ?? 0, speed = now?.speeds[k] ?? 0;
      pen.save();
      pen.translate(p.x, p.y);
      pen.rotate(-angle * Math.PI / 180);
      pen.fillStyle = Math.abs(speed) < 3 ? colours.faint : colours.edge;
      pen.beginPath();
      pen.roundRect(-11, -30, 22, 60, 6);
      pen.fill();
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
    const block = [x, y];
    this.cross(pen, block, colours.red, 7);
    pen.beginPath();
    pen.arc(block[0], block[1], 11 * this.pixel, 0, 2 * Math.PI);
    pen.stroke();
  }

  cross(pen, [x, y], colour, size) {
    const d = size * this.pixel;
    pen.strokeStyle = colour;
    pen.lineWidth = 2 * this.pixel;
    line(pen, [{ x: x - d, y: y - d }, { x: x + d, y: y + d }]);
    line(pen, [{ x: x - d, y: y + d }, { x: x + d, y: y - d }]);
  }
}
