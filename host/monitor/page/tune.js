// Every live parameter: grouped, with its range, what differs from the default, and a way back. The trims of the servos have a drawing each (trims.js).

import { Trims } from "./trims.js";

const PERIOD_MS = 120;
const SETTLE_MS = 500;
const STAND_MS = 600; // after which a robot told to stop stands
const TITLES = { drive: "Driving", servos: "Servos", motors: "Motors", windows: "Windows round the body", avoid: "Choosing a steering", battery: "Battery" };

export class Tune {
  // page: what modules get, and whether it is somebody's turn to be told.
  constructor(send, state) {
    const get = (id) => document.getElementById(id);
    Object.assign(this, { get, send, state, box: get("parameters"), restarting: false, next: {}, busy: {}, settle: null });
    this.trims = new Trims(get("trims"), (key, value) => this.change(key, value));
    get("undo").onclick = () => this.undo();
    this.clear();
  }

  clear() {
    this.box.replaceChildren();
    this.trims.clear();
    this.rows = {};
    this.groups = {};
    this.done = [];
    this.unkept = new Map();
    this.get("next-start").hidden = true;
    this.get("kept").hidden = true;
    this.count();
  }

  // Keep what was changed, if wanted, then restart the robot; it must stand for that.
  restart(keep) {
    this.send({ do: "drive", what: "stop" });
    this.restarting = keep;
    if (keep) this.send({ do: "keep" });
    else this.startAnew();
  }

  // What was to be kept must have been kept before the robot forgets it.
  replied({ command, status, text }) {
    if (command === "tune" && status !== "ok") this.refused(text);
    if (command !== "keep" || !this.restarting) return;
    this.restarting = false;
    if (status === "ok") this.startAnew();
  }

  startAnew() {
    setTimeout(() => this.send({ do: "restart" }), STAND_MS);
  }

  // The robot names what it refuses.
  refused(text) {
    for (const [key, row] of Object.entries(this.rows)) if (text.includes(key)) row.mark(text);
  }

  // What a Keep has done, in words.
  kept({ status, text, kept }) {
    const note = this.get("kept");
    const what = [...this.unkept].map((one) => one.join(" ")).join(", ") || "nothing was changed since the last time";
    note.textContent = status === "ok" ? `Kept in ${kept}: ${what}.` : `Not kept: ${text || status}.`;
    note.className = status === "ok" ? "" : "trouble";
    note.hidden = false;
    if (status === "ok") this.unkept.clear();
  }

  show(parameter) {
    if (parameter.key.startsWith("servos.trims.")) {
      this.trims.show(parameter, this.state.hello);
      return;
    }
    const row = this.rows[parameter.key] || (this.rows[parameter.key] = this.build(parameter));
    row.set(parameter.value);
    if (parameter.restart && parameter.value !== row.first) this.get("next-start").hidden = false;
    this.count();
  }

  group(name) {
    if (!this.groups[name]) {
      const box = document.createElement("details"), title = document.createElement("summary");
      box.open = true;
      title.textContent = TITLES[name] || name;
      box.append(title);
      this.box.append(box);
      this.groups[name] = box;
    }
    return this.groups[name];
  }

  build({ key, low, high, unit, meaning, value, restart, default: usual }) {
    const [section, name] = key.split(".");
    // Where the default goes with the body, what was there first stands for it.
    const known = usual ?? value;
    const box = document.createElement("div");
    box.className = "parameter";
    const id = `parameter-${key}`;
    box.innerHTML = `<label></label><input type="number"><input type="range"><button type="button">↺</button><small class="meaning"></small><p class="trouble" role="alert" hidden></p>`;
    const [label, number, slider, back, more, trouble] = box.children;
    label.textContent = name.replaceAll("_", " ");
    label.append(Object.assign(document.createElement("small"), { textContent: ` ${unit}` }));
    label.htmlFor = number.id = id;
    more.id = `${id}-meaning`;
    more.textContent = `${meaning} (${key}, ${low} to ${high}, default ${known})${restart ? "; counts from the next start" : ""}`;
    box.title = more.textContent;
    slider.setAttribute("aria-label", key);
    const mark = (text) => {
      trouble.textContent = text;
      trouble.hidden = !text;
      number.setAttribute("aria-invalid", Boolean(text));
    };
    for (const input of [number, slider]) {
      Object.assign(input, { min: low, max: high, step: 1, value });
      input.setAttribute("aria-describedby", more.id);
      input.oninput = () => {
        if (input.value === "" || !input.checkValidity()) {
          mark(`whole numbers from ${low} to ${high}${unit ? ` ${unit}` : ""}`);
          return;
        }
        mark("");
        number.value = slider.value = input.value;
        this.change(key, Number(input.value));
      };
    }
    Object.assign(back, { title: `back to ${known}`, onclick: () => this.change(key, known, true) });
    back.setAttribute("aria-label", `${key} back to ${known}`);
    this.group(section).append(box);
    const set = (now) => {
      if (document.activeElement !== number && document.activeElement !== slider) number.value = slider.value = now;
      box.classList.toggle("changed", now !== known);
      back.style.visibility = now === known ? "hidden" : "";
    };
    return { box, set, first: value, mark, differs: () => box.classList.contains("changed") };
  }

  count() {
    const differ = Object.values(this.rows).filter((row) => row.differs()).length;
    this.get("differ").textContent = Object.keys(this.rows).length ? `${differ || "none"} of ${Object.keys(this.rows).length} differ from the default` : "";
    this.get("undo").disabled = !this.done.length;
  }

  // A change by hand: remembered, so that it can be undone; one of a slider counts from where it began.
  change(key, value, at_once = false) {
    const last = this.done[this.done.length - 1];
    if (!last || last.key !== key || at_once) this.done.push({ key, before: this.state.parameter(key) });
    if (at_once) this.rows[key]?.mark("");
    this.tune(key, value, at_once);
    this.count();
  }

  undo() {
    const { key, before } = this.done.pop() || {};
    if (key === undefined || before === undefined) return;
    document.activeElement?.blur?.();
    this.tune(key, before, true);
    this.get("undo").focus();
    this.count();
  }

  // A slider makes dozens of values a second; the robot gets the last of each moment, so that a wheel turns as its trim is dragged.
  tune(key, value, shown = false) {
    this.next[key] = value;
    this.unkept.set(key, value);
    if (shown) (this.rows[key] || this.trims.rows[key])?.set(value);
    if (!this.busy[key]) this.tell(key);
    // What the robot has made of it, told when there is a rest.
    clearTimeout(this.settle);
    this.settle = setTimeout(() => {
      for (const one of Object.keys(this.next)) this.tell(one);
      this.send({ do: "list" });
    }, SETTLE_MS);
  }

  tell(key) {
    if (!(key in this.next)) return;
    this.send({ do: "tune", key, value: this.next[key] });
    delete this.next[key];
    this.busy[key] = true;
    setTimeout(() => {
      this.busy[key] = false;
      this.tell(key);
    }, PERIOD_MS);
  }
}
