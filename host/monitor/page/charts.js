// Strip charts of the last 30 seconds.

import { line, prepare } from "./canvas.js";
import { colours } from "./theme.js";

const SPAN = 30;
const WRAP = 2 ** 30 / 1e6; // the robot's clock starts over after this, s
const STRIPS = [
  { name: "AF", unit: "°", of: (d) => d.af, low: -90, high: 90, zero: 0 },
  { name: "AR", unit: "°", of: (d) => d.ar, low: -90, high: 90, zero: 0 },
  { name: "V", unit: "", of: (d) => d.v, low: 60, high: 120, zero: 90 },
  { name: "decision", unit: " ms", of: (d) => d.took, low: 0, high: null, zero: 0 },
  { name: "free", unit: " mm", of: (d) => d.free, low: 0, high: null, zero: 0 },
];

export class Charts {
  constructor(canvas) {
    this.canvas = canvas;
    this.clear();
  }

  clear() {
    this.rows = [];
    this.rounds = 0;
  }

  note(decision) {
    const last = this.rows[this.rows.length - 1];
    let time = decision.time + this.rounds * WRAP;
    if (last && time < last.time - 5) {
      // Either the clock wrapped, or the robot restarted.
      if (decision.number > last.number) time = decision.time + ++this.rounds * WRAP;
      else this.clear();
    }
    this.rows.push({ ...decision, time });
    while (this.rows.length && this.rows[0].time < time - SPAN) this.rows.shift();
  }

  draw() {
    const { pen, width, height } = prepare(this.canvas);
    const rows = this.rows;
    if (!rows.length) return;
    const end = rows[rows.length - 1].time;
    const each = height / STRIPS.length;
    const left = 74, right = width - 8;
    pen.font = "12px system-ui, sans-serif";
    STRIPS.forEach((strip, i) => {
      const top = i * each + 6, bottom = (i + 1) * each - 6;
      const values = rows.map(strip.of);
      const low = Math.min(strip.low, ...values);
      const high = strip.high === null ? Math.max(10, ...values) * 1.1 : Math.max(strip.high, ...values);
      const y = (value) => bottom - (value - low) / (high - low) * (bottom - top);
      pen.strokeStyle = colours.line;
      pen.lineWidth = 1;
      line(pen, [{ x: left, y: y(strip.zero) }, { x: right, y: y(strip.zero) }]);
      pen.strokeStyle = colours.text;
      pen.lineWidth = 1.5;
      line(pen, rows.map((row, k) => ({ x: right - (end - row.time) / SPAN * (right - left), y: y(values[k]) })));
      pen.fillStyle = colours.faint;
      pen.fillText(strip.name, 6, top + 11);
      pen.fillStyle = colours.text;
      const now = values[values.length - 1];
      pen.fillText((Number.isInteger(now) ? now : now.toFixed(1)) + strip.unit, 6, top + 27);
    });
  }
}
