// A robot with a map: where it is going, what it thinks of the way, and where to send it by a click on the map from above.

import { choices, toggle } from "./choices.js";
import { cross } from "./marks.js";
import { colours, faded } from "./theme.js";

const WALL = 0xffff, CLOSED = 0x8000;
const RAD = Math.PI / 180;
const FORM = `
  <h3>A click on the map from above</h3>
  <p class="tools" role="radiogroup" aria-label="what a click means" data-id="click"></p>
  <h3>Errand</h3>
  <p class="tools"><button type="button" data-id="on" title="forget what was found in the way, and try again">Go on</button> <button type="button" data-id="give-up">Give up</button>
    <button type="button" data-id="search" title="turn and look for where it is on its map">Where am I?</button> <button type="button" data-id="patrol" aria-pressed="false">Patrol</button></p>
  <p class="tools" role="radiogroup" aria-label="method" data-id="method"></p>
  <dl data-id="told"></dl>`;
const METHODS = ["gap", "field", "behaviour"];

export const goal = {
  id: "goal",
  title: "Goal",
  there: false,
  shown: () => goal.there,

  build(box, page) {
    this.page = page;
    box.innerHTML = FORM;
    this.get = (id) => box.querySelector(`[data-id="${id}"]`);
    const go = (what, more) => page.send({ do: "go", what, ...more });
    choices(this.get("click"), [["there", "is the goal"], ["later", "is the next goal"], ["here", "is where it stands"]], "there", (what) => { this.click = what; });
    this.method = choices(this.get("method"), METHODS.map((name) => [name, name]), "", (name) => go("method", { x: METHODS.indexOf(name) }));
    this.get("on").onclick = () => go("on");
    this.get("give-up").onclick = () => go("give up");
    this.get("search").onclick = () => go("search");
    toggle(this.get("patrol"), (on) => go("patrol", { x: on ? 1 : 0 }));
    this.click = "there";
    this.clear();
  },

  clear() {
    Object.assign(this, { there: false, told: null, plan: null, cells: [], frame: null });
  },

  hear: {
    connected() { goal.clear(); },
    map(message) {
      goal.plan = message;
      goal.there = true;
    },
    cells({ first, cells }) { cells.forEach((cell, k) => { goal.cells[first + k] = cell; }); },
    goal(message) {
      goal.told = message;
      goal.there = true;
      goal.show(message);
      // Where the map lies under what is drawn: the robot is in both.
      const place = goal.page.state.truth || goal.page.state.pose;
      if (place && message.pose_state !== "lost") goal.frame = { place, on: message, turn: (place.heading - message.heading) * RAD };
    },
  },

  show({ state, alarm, method, pose_state, error, fits, x, y, length, door, open, searches, waiting, patrol }) {
    const rows = [
      ["errand", alarm ? `${state}: ${alarm}` : state, Boolean(alarm)], ["its place", `${pose_state}, ${x}, ${y} mm, within ${error} mm, ${fits} % of the points fit`, pose_state === "lost"],
      ["way", length === null ? "none" : `${length.toFixed(1)} cells`], ["door", door === null ? "none" : `number ${door + 1}${open === null ? "" : `, ${open} mm open`}`],
      ["goals waiting", String(waiting)], ["searches", String(searches)],
    ];
    this.get("told").replaceChildren(...rows.flatMap(([name, text, bad]) => [
      Object.assign(document.createElement("dt"), { textContent: name }), Object.assign(document.createElement("dd"), { textContent: text, className: bad ? "bad" : "" }),
    ]));
    this.method(method);
    this.get("patrol").setAttribute("aria-pressed", patrol);
  },

  // From the map to what is drawn, and back.
  drawn(x, y) {
    const { place, on, turn } = this.frame, s = Math.sin(turn), c = Math.cos(turn), dx = x - on.x, dy = y - on.y;
    return { x: place.x + dx * c + dy * s, y: place.y - dx * s + dy * c };
  },

  mapped(x, y) {
    if (!this.frame) return { x, y };
    const { place, on, turn } = this.frame, s = Math.sin(turn), c = Math.cos(turn), dx = x - place.x, dy = y - place.y;
    return { x: on.x + dx * c - dy * s, y: on.y + dx * s + dy * c };
  },

  press({ x, y }) {
    const at = this.mapped(x, y);
    return this.page.send({ do: "go", what: this.click, x: Math.round(at.x), y: Math.round(at.y), heading: this.told?.heading ?? 0 });
  },

  drawWorld(pen, view) {
    if (!this.frame) return;
    const { plan, told } = this;
    if (plan) this.drawPlan(pen, view, plan);
    if (!["going", "there", "alarm"].includes(told.state)) return;
    const to = this.drawn(...told.goal), steer = this.drawn(...told.steer);
    pen.lineWidth = 2 * view.pixel;
    pen.strokeStyle = colours.chosen;
    pen.beginPath();
    pen.arc(to.x, to.y, 9 * view.pixel, 0, 2 * Math.PI);
    pen.moveTo(this.frame.place.x, this.frame.place.y);
    pen.lineTo(steer.x, steer.y);
    pen.stroke();
    cross(pen, to.x, to.y, told.state === "alarm" ? colours.red : colours.chosen, 4, view.pixel);
  },

  drawPlan(pen, view, { cols, cell, doors }) {
    this.cells.forEach((word, k) => {
      if (!(word & CLOSED)) return;
      const [x, y] = [(k % cols) * cell, Math.floor(k / cols) * cell];
      const corners = [[x, y], [x + cell, y], [x + cell, y + cell], [x, y + cell]].map((one) => this.drawn(...one));
      pen.fillStyle = word === WALL ? faded(colours.wall, 0.2) : faded(colours.refused, 0.35); // found in the way, and not on its map
      pen.beginPath();
      corners.forEach((p, i) => (i ? pen.lineTo(p.x, p.y) : pen.moveTo(p.x, p.y)));
      pen.fill();
    });
    pen.lineWidth = 3 * view.pixel;
    pen.strokeStyle = colours.other;
    for (const { x, y, normal, width } of doors) {
      const across = normal * RAD, dx = Math.cos(across) * width / 2, dy = -Math.sin(across) * width / 2;
      const [a, b] = [this.drawn(x - dx, y - dy), this.drawn(x + dx, y + dy)];
      pen.beginPath();
      pen.moveTo(a.x, a.y);
      pen.lineTo(b.x, b.y);
      pen.stroke();
    }
  },
};
