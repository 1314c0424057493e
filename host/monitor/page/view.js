// What part of a floor a canvas shows: all of it, or the robot followed, or what a hand has chosen with wheel, fingers or keys.

const CLICK_PX = 5; // a pointer that moves less means the place it points at
const STEP = 1.25;
const NEAREST = 4, FARTHEST = 0.01; // CSS pixels a mm

export class View {
  // redraw(): something has moved. press(point): a click, { x, y } mm. grab(point): true if what lies there is dragged instead of the view; drag(point, done).
  constructor(canvas, redraw, { press, grab, drag } = {}) {
    Object.assign(this, { canvas, redraw, press, grab, drag, mode: "whole", hover: null, fingers: new Map(), changed: () => {} });
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.onpointerdown = (event) => this.down(event);
    canvas.onpointermove = (event) => this.move(event);
    canvas.onpointerup = canvas.onpointercancel = (event) => this.up(event);
    canvas.onpointerleave = () => this.look(null);
    canvas.onkeydown = (event) => this.key(event);
  }

  // For this frame: { scale, x, y, width, height }, the middle in mm. whole: what shows all; robot: where it is.
  frame(width, height, whole, robot) {
    if (this.mode === "whole") this.own = { ...whole };
    if (this.mode === "follow") this.own = { scale: Math.max(this.own?.scale ?? 0, whole.scale), x: robot.x, y: robot.y };
    this.now = { ...this.own, width, height };
    return this.now;
  }

  choose(mode) {
    if (mode === "follow" && this.mode !== "follow" && this.now) this.own = { ...this.own, scale: Math.max(this.now.scale, this.now.width / 2500) };
    this.mode = mode;
    this.changed();
    this.redraw();
  }

  point(x, y) {
    const { scale, width, height } = this.now;
    return { x: this.now.x + (x - width / 2) / scale, y: this.now.y - (y - height / 2) / scale };
  }

  zoom(factor, x = this.now.width / 2, y = this.now.height / 2) {
    if (!this.now) return;
    const before = this.point(x, y);
    const scale = Math.min(NEAREST, Math.max(FARTHEST, this.now.scale * factor));
    this.own = { ...this.own, scale };
    if (this.mode !== "follow") {
      this.mode = "free";
      const after = { x: this.own.x + (x - this.now.width / 2) / scale, y: this.own.y - (y - this.now.height / 2) / scale };
      this.own = { scale, x: this.own.x + before.x - after.x, y: this.own.y + before.y - after.y };
    }
    this.now = { ...this.now, ...this.own };
    this.changed();
    this.redraw();
  }

  pan(dx, dy) {
    if (!this.now) return;
    this.mode = "free";
    this.own = { ...this.own, x: this.own.x - dx / this.now.scale, y: this.own.y + dy / this.now.scale };
    this.changed();
    this.redraw();
  }

  wheel(event) {
    // A page that scrolls goes on scrolling, unless the map has been chosen.
    if (document.documentElement.scrollHeight > innerHeight + 1 && !event.ctrlKey && document.activeElement !== this.canvas) return;
    event.preventDefault();
    this.zoom(event.deltaY < 0 ? STEP : 1 / STEP, event.offsetX, event.offsetY);
  }

  down(event) {
    if (!this.now) return;
    const at = { x: event.offsetX, y: event.offsetY };
    this.fingers.set(event.pointerId, at);
    this.travelled = this.fingers.size > 1 ? CLICK_PX : 0;
    this.grabbed = this.fingers.size === 1 && this.grab?.(this.point(at.x, at.y));
    if (event.pointerType === "mouse" || this.grabbed) this.canvas.setPointerCapture(event.pointerId);
  }

  move(event) {
    const to = { x: event.offsetX, y: event.offsetY }, from = this.fingers.get(event.pointerId);
    if (!this.now) return;
    if (!from) {
      this.look(to);
      return;
    }
    this.travelled += Math.hypot(to.x - from.x, to.y - from.y);
    const other = [...this.fingers].find(([id]) => id !== event.pointerId)?.[1];
    this.fingers.set(event.pointerId, to);
    if (this.travelled < CLICK_PX) return;
    if (this.grabbed) {
      this.drag(this.point(to.x, to.y), false);
    } else {
      if (other) this.zoom(Math.hypot(to.x - other.x, to.y - other.y) / Math.max(1, Math.hypot(from.x - other.x, from.y - other.y)), other.x, other.y);
      else if (event.pointerType === "mouse") this.pan(to.x - from.x, to.y - from.y);
    }
    this.redraw();
  }

  up(event) {
    const at = this.fingers.get(event.pointerId);
    this.fingers.delete(event.pointerId);
    if (!at || !this.now) return;
    const point = this.point(event.offsetX, event.offsetY);
    if (this.grabbed) this.drag(point, true);
    else if (this.travelled < CLICK_PX && event.type === "pointerup") {
      this.look({ x: event.offsetX, y: event.offsetY });
      this.press?.(point);
    }
    this.grabbed = false;
  }

  look(at) {
    this.hover = at;
    this.redraw();
  }

  key(event) {
    const pans = { ArrowLeft: [40, 0], ArrowRight: [-40, 0], ArrowUp: [0, 40], ArrowDown: [0, -40] };
    if (event.key === "+" || event.key === "=") this.zoom(STEP);
    else if (event.key === "-") this.zoom(1 / STEP);
    else if (event.key === "0") this.choose("whole");
    else if (pans[event.code]) this.pan(...pans[event.code]);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}
