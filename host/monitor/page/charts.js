// Charts of the whole run: steering, speed, how long each decision took and how far the way is free, with marks where it stopped and why.

import { line, prepare } from "./canvas.js";
import { colours } from "./theme.js";

const WRAP = 2 ** 30 / 1e6; // the robot's clock starts over after this, s
const MOST = 40000; // decisions kept, an hour of them
const STEPS = [1, 2, 5, 10, 20, 30, 60, 120, 300, 600]; // s between the marks of the axis
const LEFT = 92, RIGHT = 10, BOTTOM = 20, TOP = 16;

// Each strip: its lines, its range ("low" to the first of "high" that holds what is seen), where it has rules, and its share of the height.
export const STRIPS = [
  { name: "steering", unit: "°", lines: [["AF", (d) => d.af], ["AR", (d) => d.ar]], high: [15, 30, 60, 90], both: true, rules: [-60, -30, -12, 0, 12, 30, 60], share: 2 },
  { name: "speed", unit: " V", lines: [["V", (d) => d.v]], high: [30, 60, 90], both: true, middle: 90, rules: [70, 90, 110], share: 1 },
  { name: "decision", unit: " ms", lines: [["decision", (d) => d.took]], high: [20, 50, 100, 200, 500], rules: [0, 20, 50, 100, 200], share: 1 },
  { name: "free way", unit: " mm", lines: [["free", (d) => d.free]], high: [800, 1500, 3000, 33000], rules: [0, 350, 700, 1500], share: 1 },
];

// The first of the moments at which it stood still after it had moved, and why: [{ at, why }].
export function stops(rows) {
  return rows.filter((row, k) => k && row.v === 90 && rows[k - 1].v !== 90).map(({ at, why, state }) => ({ at, why, state }));
}

export class Charts {
  // tip: words beside the pointer; words(row): why, in words; seek(at): a click while a recording is open.
  constructor(canvas, redraw, tip, words, seek) {
    Object.assign(this, { canvas, redraw, tip, words, seek, span: 30, end: null, pointer: null });
    canvas.onpointermove = (event) => {
      if (this.dragged !== undefined && event.buttons) this.scroll((this.dragged - event.offsetX) / this.width * this.span);
      this.dragged = event.buttons ? event.offsetX : undefined;
      this.look(event.offsetX);
    };
    canvas.onpointerleave = () => this.look(null);
    canvas.onclick = (event) => this.seek?.(this.time(event.offsetX));
    canvas.onkeydown = (event) => this.key(event);
    this.clear();
  }

  clear() {
    this.rows = [];
    this.other = null;
    this.whole = false; // the rows are those of a recording, all of it
    this.rounds = 0;
    this.end = null;
    this.cursor = undefined;
  }

  note(decision) {
    if (this.whole) return;
    const last = this.rows[this.rows.length - 1];
    let time = decision.time + this.rounds * WRAP;
    if (last && time < last.time - 5) {
      // Either the clock wrapped, or the robot restarted.
      if (decision.number > last.number) time = decision.time + ++this.rounds * WRAP;
      else this.clear();
    }
    this.first = this.rows.length ? this.first : time;
    this.rows.push({ ...decision, time, at: time - this.first });
    if (this.rows.length > MOST) this.rows.shift();
  }

  // All decisions of a recording, each with `at`, s from its start.
  run(rows) {
    this.rows = rows;
    this.whole = true;
  }

  // Arrows lead the pointer, whose values are told, and at an edge the charts; pages and ends scroll.
  key(event) {
    const scroll = { PageUp: -0.8, PageDown: 0.8, Home: -1e6, End: 1e6 }[event.code];
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.code];
    if (scroll) {
      this.scroll(scroll * this.shown);
    } else if (step) {
      const at = (this.pointer ?? LEFT + this.width / 2) + step * this.width / 60;
      if (at < LEFT || at > LEFT + this.width) this.scroll(step * 0.1 * this.shown);
      else this.look(at);
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  }

  get length() {
    return Math.max(this.rows[this.rows.length - 1]?.at ?? 0, this.other?.[this.other.length - 1]?.at ?? 0);
  }

  get shown() {
    return this.span === Infinity ? Math.max(this.length, 1) : this.span;
  }

  // The right edge: where it was scrolled to, or else the latest.
  get edge() {
    const latest = Math.max(this.whole ? Math.max(this.cursor ?? 0, Math.min(this.shown, this.length)) : this.length, this.shown);
    return this.span === Infinity ? this.shown : this.end ?? latest;
  }

  scroll(seconds) {
    this.to(this.edge + seconds);
  }

  to(edge) {
    const last = Math.max(this.length, this.shown);
    this.end = edge >= last - 0.05 ? null : Math.max(edge, this.shown);
    this.redraw();
  }

  time(x) {
    return this.edge - this.shown + (x - LEFT) / this.width * this.shown;
  }

  look(x) {
    this.pointer = x === null || x < LEFT ? null : x;
    this.redraw();
  }

  draw() {
    const { pen, width, height } = prepare(this.canvas);
    this.width = width - LEFT - RIGHT;
    const from = this.edge - this.shown;
    const x = (at) => LEFT + (at - from) / this.shown * this.width;
    pen.font = "11px system-ui, sans-serif";
    this.axis(pen, from, x, height);
    const shares = STRIPS.reduce((sum, strip) => sum + strip.share, 0);
    let top = TOP;
    for (const strip of STRIPS) {
      const bottom = top + (height - TOP - BOTTOM) * strip.share / shares;
      this.strip(pen, strip, top + 4, bottom - 4, x, from);
      top = bottom;
    }
    this.marks(pen, x, from, height);
    if (this.whole && this.cursor !== undefined) this.upright(pen, x(this.cursor), height, colours.chosen, []);
    this.hover(pen, x, height);
  }

  axis(pen, from, x, height) {
    const step = STEPS.find((one) => one / this.shown * this.width > 44) || 1200;
    pen.fillStyle = colours.faint;
    pen.strokeStyle = colours.faintLine;
    pen.textAlign = "center";
    for (let at = Math.max(0, Math.ceil(from / step) * step); at <= from + this.shown; at += step) {
      line(pen, [{ x: x(at), y: TOP }, { x: x(at), y: height - BOTTOM + 3 }]);
      pen.fillText(at < 60 ? `${at} s` : `${Math.floor(at / 60)}:${String(at % 60).padStart(2, "0")}`, x(at), height - 5);
    }
    pen.textAlign = "left";
  }

  strip(pen, strip, top, bottom, x, from) {
    const rows = this.seen(this.rows, from), others = this.seen(this.other || [], from);
    const middle = strip.middle ?? 0;
    let most = 0;
    for (const some of [rows, others]) for (const row of some) for (const [, of] of strip.lines) most = Math.max(most, Math.abs(of(row) - middle));
    const high = strip.high.find((one) => one >= most) ?? strip.high[strip.high.length - 1];
    const low = strip.both ? middle - high : middle;
    const y = (value) => bottom - (Math.min(Math.max(value, low), middle + high) - low) / (middle + high - low) * (bottom - top);
    pen.lineWidth = 1;
    let free = Infinity;
    for (const rule of strip.rules) {
      if (rule < low || rule > middle + high) continue;
      pen.strokeStyle = rule === middle ? colours.line : colours.faintLine;
      line(pen, [{ x: LEFT, y: y(rule) }, { x: LEFT + this.width, y: y(rule) }]);
      if (free - y(rule) < 11) continue;
      free = y(rule);
      pen.fillStyle = colours.faint;
      pen.textAlign = "right";
      pen.fillText(String(rule), LEFT - 5, y(rule) + 4);
      pen.textAlign = "left";
    }
    pen.fillStyle = colours.text;
    pen.fillText(strip.name, 4, top + 8);
    pen.fillStyle = colours.faint;
    pen.fillText(strip.lines.length > 1 ? "AF, AR -- °" : strip.unit.trim(), 4, top + 21);
    pen.save();
    pen.beginPath();
    pen.rect(LEFT, top - 3, this.width, bottom - top + 6);
    pen.clip();
    for (const [some, colour] of [[others, colours.other], [rows, colours.text]]) {
      strip.lines.forEach(([, of], k) => {
        pen.strokeStyle = colour;
        pen.lineWidth = 1.5;
        pen.setLineDash(k ? [4, 3] : []);
        line(pen, stairs(some, of, x, y));
      });
    }
    pen.restore();
  }

  // Those within what is shown, and one more on either side.
  seen(rows, from) {
    let first = rows.findIndex((row) => row.at >= from), last = rows.length;
    if (first < 0) first = rows.length;
    while (last > first && rows[last - 1].at > from + this.shown) last--;
    return rows.slice(Math.max(0, first - 1), last + 1);
  }

  // Where it stopped, and why, as far as there is room until the next stop.
  marks(pen, x, from, height) {
    const found = stops(this.seen(this.rows, from)).map((stop) => ({ ...stop, x: x(stop.at) })).filter((stop) => stop.x >= LEFT);
    found.forEach((stop, k) => {
      this.upright(pen, stop.x, height, colours.faint, [2, 3]);
      pen.fillStyle = colours.text;
      pen.fillText("■", stop.x - 4, 11);
      const room = (found[k + 1]?.x ?? LEFT + this.width) - stop.x - 16;
      let text = this.words(stop);
      if (pen.measureText(text).width > room) {
        while (text && pen.measureText(`${text}…`).width > room) text = text.slice(0, -1);
        text = text.length > 3 ? `${text}…` : "";
      }
      pen.fillText(text, stop.x + 8, 11);
    });
  }

  upright(pen, x, height, colour, dash) {
    if (x < LEFT - 1) return;
    pen.setLineDash(dash);
    pen.strokeStyle = colour;
    pen.lineWidth = 1;
    line(pen, [{ x, y: TOP }, { x, y: height - BOTTOM }]);
    pen.setLineDash([]);
  }

  // The row in force at a time.
  row(rows, at) {
    let found = null;
    for (const row of rows) {
      if (row.at > at) break;
      found = row;
    }
    return found;
  }

  hover(pen, x, height) {
    if (this.pointer === null) return this.tip("");
    const at = this.time(this.pointer);
    this.upright(pen, this.pointer, height, colours.text, []);
    const say = (row) => `AF ${row.af}° AR ${row.ar}° V ${row.v}, decided in ${row.took.toFixed(1)} ms, free ${row.free} mm: ${this.words(row)}`;
    const row = this.row(this.rows, at), other = this.other && this.row(this.other, at);
    return this.tip([row && `${at.toFixed(1)} s: ${say(row)}`, other && `the other: ${say(other)}`].filter(Boolean).join(" | "), this.pointer, 30);
  }
}

// A decision holds until the next; what would not be seen, because nothing changes within a pixel, is left out.
function stairs(rows, of, x, y) {
  const out = [];
  let last = null;
  rows.forEach((row, k) => {
    const at = { x: x(row.at), y: y(of(row)) };
    if (last && k < rows.length - 1 && at.x - last.x < 1 && Math.abs(at.y - last.y) < 0.5) return;
    if (last) out.push({ x: at.x, y: last.y });
    out.push(at);
    last = at;
  });
  return out;
}
