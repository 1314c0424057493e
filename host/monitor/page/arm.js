// The arm from the side: where it is, what is planned as a ghost; play, hold, home; each joint by hand, saved poses, a sequence of reaches.

import { line, prepare } from "./canvas.js";
import { faded, onTheme } from "./theme.js";

const ALIVE_MS = 100; // the arm freezes 300 ms after the last word
const POSES = "gapseeker.arm.poses";
const STATES = { off: "without power", wakes: "its servos wake", holds: "holds", moves: "goes to a pose", plays: "plays" };
const RAD = Math.PI / 180;
const FORM = `
  <div class="arm">
    <canvas data-id="side" role="img" aria-label="the arm from the side"></canvas>
    <div>
      <p class="tools"><b data-id="state" role="status">-</b></p>
      <p class="tools"><button type="button" data-id="home">Home</button> <button type="button" class="main" data-id="play">Play</button> <button type="button" data-id="hold">Hold</button></p>
      <p class="tools"><label>reach <select data-id="reach"></select></label> <button type="button" data-id="look">Look again</button> <button type="button" data-id="add">Add to the sequence</button></p>
      <p class="tools" data-id="sequence" aria-label="sequence of reaches"></p>
      <div data-id="joints"></div>
      <p class="tools"><label>pose <input data-id="pose-name" size="10" placeholder="its name"></label> <button type="button" data-id="save">Save this pose</button></p>
      <p class="tools" data-id="poses"></p>
      <p class="trouble" role="alert" data-id="trouble" hidden></p>
    </div>
  </div>`;

export const arm = {
  id: "arm",
  title: "Arm",
  shown: (state) => Boolean(state.arm),
  reaches: [],
  sequence: [],

  build(box, page) {
    Object.assign(this, { page, box, after: null, waiting: null });
    box.innerHTML = FORM;
    this.get = (id) => box.querySelector(`[data-id="${id}"]`);
    const { get } = this;
    get("home").onclick = () => this.command({ what: "home" });
    get("hold").onclick = () => this.hold();
    get("play").onclick = () => this.playAll(this.sequence.length ? [...this.sequence] : [get("reach").value]);
    get("look").onclick = () => page.send({ do: "reaches" });
    get("reach").onchange = () => this.draw();
    get("add").onclick = () => {
      if (get("reach").value) this.sequence.push(get("reach").value);
      this.showSequence();
    };
    get("save").onclick = () => this.save();
    this.showPoses();
    onTheme(() => this.draw());
    setInterval(() => this.alive(), ALIVE_MS);
    new ResizeObserver(() => this.draw()).observe(get("side"));
  },

  hear: {
    connected() { Object.assign(arm, { asked: false, after: null, waiting: null, seen: "" }); },
    arm(message) { arm.take(message); },
    reaches(message) { arm.offer(message); },
    reply({ command, status, text }) {
      if (command !== "arm" && command !== "reach") return;
      if (status !== "ok") return arm.stopped(text);
      if (!arm.waiting || arm.waiting !== command) return;
      const then = arm.after;
      Object.assign(arm, { waiting: null, after: null });
      then?.(text);
    },
    refused(message) {
      if (message.do === "arm" || message.do === "reach") arm.stopped(message.text);
    },
  },

  // A command; then(text of its reply).
  command(what, then = null) {
    this.trouble("");
    if (!this.page.send({ do: what.do || "arm", ...what })) return;
    Object.assign(this, { waiting: what.do || "arm", after: then });
    this.began = performance.now();
  },

  hold() {
    this.queue = [];
    this.page.send({ do: "arm", what: "hold" });
  },

  // While it moves this page says again and again that somebody is there; closed, the arm freezes.
  alive() {
    const moving = ["moves", "plays"].includes(this.now?.state) || performance.now() - (this.began || -1e9) < 600;
    if (moving && !this.waiting) this.page.send({ do: "arm", what: "go on" });
  },

  take(message) {
    const before = this.now;
    this.now = message;
    if (!this.asked) {
      this.asked = true;
      this.page.send({ do: "reaches" });
    }
    const stopped = message.state === "holds" && before && before.state !== "holds";
    const why = message.why === "nothing" ? "" : `: ${message.why}`;
    const words = STATES[message.state] + (message.state === "holds" || message.state === "off" ? why : "");
    if (this.get("state").textContent !== words) this.get("state").textContent = words;
    this.get("home").textContent = message.state === "off" ? "Switch on, at its rest pose" : "Home";
    this.showJoints(message.angles);
    this.draw();
    if (stopped && message.why === "nothing") this.next();
    else if (stopped) this.queue = [];
  },

  offer({ list, wrong }) {
    const { get } = this, chosen = get("reach").value;
    this.reaches = list;
    get("reach").replaceChildren(...list.map(({ name, time }) => new Option(`${name} (${time.toFixed(1)} s)`, name)));
    if (list.some(({ name }) => name === chosen)) get("reach").value = chosen;
    this.sequence = this.sequence.filter((name) => list.some((one) => one.name === name));
    this.trouble(wrong.join("; ") || (list.length ? "" : "no trajectory in out/arm/ yet: python -m host.arm plan ... --out out/arm/NAME.json"));
    this.seen = "";
    this.showSequence();
    this.draw();
  },

  chosen() { return this.reaches.find(({ name }) => name === this.get("reach").value); },

  // The reaches of a sequence one after the other: uploaded, gone to where it begins, played.
  playAll(names) {
    this.queue = names.filter(Boolean);
    this.next();
  },

  next() {
    if (this.going) { // it stands where a trajectory begins
      this.going = false;
      return this.command({ what: "play" });
    }
    const name = this.queue?.shift(), reach = this.reaches.find((one) => one.name === name);
    if (!reach) return;
    this.get("reach").value = name;
    this.upload(reach, 0);
  },

  upload(reach, k) {
    if (k < reach.pieces.length) {
      this.command({ do: "reach", offset: k * reach.piece, data: reach.pieces[k] }, () => this.upload(reach, k + 1));
    } else {
      this.command({ what: "play", approach: true }, (text) => { this.going = text.startsWith("first"); });
    }
  },

  stopped(text) {
    Object.assign(this, { waiting: null, after: null, going: false, queue: [] });
    this.trouble(text);
  },

  showSequence() {
    const box = this.get("sequence");
    box.replaceChildren(...this.sequence.map((name, k) => {
      const button = Object.assign(document.createElement("button"), { type: "button", textContent: `${k + 1}. ${name} ✕`, title: "take it out" });
      button.onclick = () => {
        this.sequence.splice(k, 1);
        this.showSequence();
      };
      return button;
    }));
    this.get("play").textContent = this.sequence.length ? "Play the sequence" : "Play";
  },

  // A slider for each joint: moved, the arm goes there, slowly.
  showJoints(angles) {
    const shape = this.shape(), key = `${angles.length} ${shape?.name}`;
    if (this.seen !== key) {
      this.seen = key;
      this.sliders = angles.map((angle, k) => this.slider(k, shape));
      this.get("joints").replaceChildren(...this.sliders.map(({ box }) => box));
    }
    angles.forEach((angle, k) => {
      const { input, out } = this.sliders[k];
      if (document.activeElement !== input || this.now.state !== "holds") input.value = angle;
      out.textContent = `${angle.toFixed(1)}°`;
    });
  },

  slider(k, shape) {
    const box = document.createElement("p"), label = document.createElement("label"), input = document.createElement("input"), out = document.createElement("output");
    const [low, high] = shape?.limits[k] || [-180, 180];
    box.className = "joint";
    Object.assign(input, { type: "range", min: Math.ceil(low), max: Math.floor(high), step: 0.5 });
    label.append(`${shape?.names[k] || `joint ${k + 1}`} `, input);
    input.onchange = () => {
      this.queue = [];
      this.command({ what: "joint", joint: k, angle: Number(input.value) });
    };
    box.append(label, out);
    return { box, input, out };
  },

  poses: () => JSON.parse(localStorage.getItem(POSES) || "[]"),

  save() {
    if (!this.now) return;
    const name = this.get("pose-name").value.trim() || `pose ${this.poses().length + 1}`;
    localStorage.setItem(POSES, JSON.stringify([...this.poses().filter((one) => one.name !== name), { name, angles: this.now.angles }]));
    this.get("pose-name").value = "";
    this.showPoses();
  },

  showPoses() {
    this.get("poses").replaceChildren(...this.poses().flatMap(({ name, angles }) => {
      const go = Object.assign(document.createElement("button"), { type: "button", textContent: name, title: angles.map((a) => a.toFixed(1)).join(", ") });
      const drop = Object.assign(document.createElement("button"), { type: "button", textContent: "✕", title: `forget ${name}` });
      go.onclick = () => {
        this.queue = [];
        this.command({ what: "pose", angles });
      };
      drop.onclick = () => {
        localStorage.setItem(POSES, JSON.stringify(this.poses().filter((one) => one.name !== name)));
        this.showPoses();
      };
      return [go, drop];
    }));
  },

  trouble(text) {
    this.get("trouble").textContent = text;
    this.get("trouble").hidden = !text;
  },

  shape() { return (this.chosen() || this.reaches[0])?.arm; },

  draw() {
    const canvas = this.get("side"), shape = this.shape(), colours = this.page.colours;
    if (!canvas.clientWidth) return;
    const { pen, width, height } = prepare(canvas);
    if (!shape) return;
    const reach = this.chosen(), far = shape.lengths.reduce((a, b) => a + b, 0) * 1.05;
    const scale = Math.min(width / (2 * far), height / (1.5 * far));
    const to = (x, y) => ({ x: width / 2 + x * scale, y: height * 0.7 - y * scale });
    pen.lineJoin = pen.lineCap = "round";
    for (const one of reach?.obstacles || []) obstacle(pen, one, to, scale, far, faded(colours.wall, 0.5));
    if (reach) {
      pen.strokeStyle = faded(colours.chosen, 0.9);
      pen.lineWidth = 1.5;
      line(pen, reach.path.map(([x, y]) => to(x, y)));
      for (const k of [0, 15, 30, 45, reach.angles.length - 1]) {
        if (reach.angles[k]) links(pen, shape, reach.angles[k], to, faded(colours.chosen, k && k < reach.angles.length - 1 ? 0.25 : 0.5), 3);
      }
    }
    const base = to(shape.base[0], shape.base[1]);
    pen.fillStyle = colours.edge;
    pen.fillRect(base.x - 7, base.y - 4, 14, 12);
    if (this.now) links(pen, shape, this.now.angles, to, this.now.state === "off" ? colours.faint : colours.edge, 6, colours.card);
  },
};

function links(pen, shape, angles, to, colour, width, joints = null) {
  let [x, y] = shape.base, turned = 0;
  const points = [to(x, y)];
  shape.lengths.forEach((length, k) => {
    turned += angles[k] * RAD;
    x += length * Math.cos(turned);
    y += length * Math.sin(turned);
    points.push(to(x, y));
  });
  Object.assign(pen, { strokeStyle: colour, lineWidth: width });
  line(pen, points);
  if (!joints) return;
  pen.fillStyle = joints;
  pen.lineWidth = 2;
  for (const point of points.slice(0, -1)) {
    pen.beginPath();
    pen.arc(point.x, point.y, 4.5, 0, 2 * Math.PI);
    pen.fill();
    pen.stroke();
  }
}

function obstacle(pen, one, to, scale, far, colour) {
  pen.fillStyle = colour;
  pen.beginPath();
  if (one.disc) {
    const [x, y, radius] = one.disc, at = to(x, y);
    pen.arc(at.x, at.y, radius * scale, 0, 2 * Math.PI);
  } else {
    const box = one.box, [x, y] = box || one.half_plane, angle = (box ? box[4] : one.half_plane[2]) * RAD;
    const corners = box ? [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([u, v]) => [u * box[2] / 2, v * box[3] / 2]) : [[0, -9 * far], [0, 9 * far], [-9 * far, 9 * far], [-9 * far, -9 * far]];
    corners.forEach(([u, v], k) => {
      const at = to(x + u * Math.cos(angle) - v * Math.sin(angle), y + u * Math.sin(angle) + v * Math.cos(angle));
      if (k) pen.lineTo(at.x, at.y);
      else pen.moveTo(at.x, at.y);
    });
  }
  pen.fill();
}
