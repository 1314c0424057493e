// The world from above: walls and the true place in the twin; otherwise the way the robot believes it has come.

import { line, polygon, prepare } from "./canvas.js";
import { bodyOf, carry, corners } from "./geometry.js";
import { colours, faded } from "./theme.js";

const TRACK = 4000; // places remembered

export class World {
  constructor(canvas, state) {
    this.canvas = canvas;
    this.state = state;
    this.clear();
    canvas.onclick = (event) => {
      if (!this.view) return;
      const point = this.point(event.offsetX, event.offsetY);
      this.panels?.press({ ...point, robot: this.back(point) });
    };
  }

  // Where on the floor a place of the canvas is, mm.
  point(x, y) {
    const { width, height, scale, middle } = this.view;
    return { x: middle.x + (x - width / 2) / scale, y: middle.y - (y - height / 2) / scale };
  }

  clear() {
    this.track = [];
    this.believed = [];
    this.pair = null; // a true place and the believed one of the same moment
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

  // Places of the robot's own frame, in which it says where it is, and of the one that is drawn.
  there(p) {
    return this.state.truth && this.pair ? this.aligned(p) : p;
  }

  back(p) {
    if (!this.state.truth || !this.pair) return { x: p.x, y: p.y };
    const { truth, pose } = this.pair;
    const turn = (truth.heading - pose.heading) * Math.PI / 180;
    const s = Math.sin(turn), c = Math.cos(turn), dx = p.x - truth.x, dy = p.y - truth.y;
    return { x: pose.x + dx * c - dy * s, y: pose.y + dx * s + dy * c };
  }

  // Where a believed place would be, had the robot erred nowhere since it was first seen here.
  aligned(p) {
    const { truth, pose } = this.pair;
    const turn = (truth.heading - pose.heading) * Math.PI / 180;
    return carry({ x: p.x - pose.x, y: p.y - pose.y }, { x: truth.x, y: truth.y, heading: turn });
  }

  push(track, { x, y, heading }) {
    const last = track[track.length - 1];
    if (last && Math.hypot(x - last.x, y - last.y) < 5 && Math.abs(heading - last.heading) < 1) return;
    track.push({ x, y, heading });
    if (track.length > TRACK) track.shift();
  }

  draw() {
    const { pen, width, height } = prepare(this.canvas);
    const body = bodyOf(this.state.hello);
    const truth = this.state.truth;
    const walls = this.state.world?.walls || [];
    const place = truth || this.state.pose;
    if (!place) return;
    const xs = [place.x - 500, place.x + 500], ys = [place.y - 500, place.y + 500];
    for (const [x1, y1, x2, y2] of walls) {
      xs.push(x1, x2);
      ys.push(y1, y2);
    }
    for (const p of truth ? this.track : this.believed) {
      xs.push(p.x);
      ys.push(p.y);
    }
    const left = Math.min(...xs), right = Math.max(...xs), low = Math.min(...ys), high = Math.max(...ys);
    const scale = Math.min(width / (right - left), height / (high - low)) * 0.94;
    pen.translate(width / 2, height / 2);
    pen.scale(scale, -scale);
    const middle = { x: (left + right) / 2, y: (low + high) / 2 };
    pen.translate(-middle.x, -middle.y);
    this.view = { width, height, scale, middle };

    pen.lineCap = "round";
    pen.lineWidth = 3 / scale;
    pen.strokeStyle = colours.wall;
    for (const [x1, y1, x2, y2] of walls) line(pen, [{ x: x1, y: y1 }, { x: x2, y: y2 }]);

    pen.lineWidth = 1.5 / scale;
    if (truth && this.pair) {
      pen.strokeStyle = colours.faint;
      line(pen, this.believed.map((p) => this.aligned(p)));
    }
    pen.strokeStyle = colours.chosen;
    line(pen, truth ? this.track : this.believed);

    const at = { x: place.x, y: place.y, heading: place.heading * Math.PI / 180 };
    pen.beginPath();
    polygon(pen, corners(body).map((p) => carry(p, at)));
    pen.fillStyle = faded(colours.chosen, .35);
    pen.fill();
    pen.strokeStyle = colours.edge;
    pen.stroke();
    pen.beginPath();
    const nose = carry({ x: 0, y: body.length / 2 - 60 }, at);
    pen.arc(nose.x, nose.y, 40, 0, 2 * Math.PI);
    pen.fillStyle = colours.edge;
    pen.fill();
    this.panels?.draw("drawWorld", pen, { pixel: 1 / scale, fromRobot: (p) => this.there(p) });
  }
}
