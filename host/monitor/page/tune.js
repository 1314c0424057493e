// Every live parameter with its unit, range and meaning; servo trims, with the wheel turning as one drags.

const PERIOD_MS = 120;
const SETTLE_MS = 500;
const STAND_MS = 600; // after which a robot told to stop stands
export class Tune {
  // notice: shown while something was changed that counts from the next start.
  constructor(box, trims, notice, send) {
    Object.assign(this, { box, trims, notice, send });
    this.restarting = false;
    this.rows = {};
    this.next = {};
    this.busy = {};
    this.settle = null;
    this.unkept = new Map();
  }

  clear() {
    this.box.replaceChildren();
    this.trims.replaceChildren();
    this.rows = {};
    this.unkept.clear();
    this.notice.hidden = true;
  }

  // Keep what was changed, if wanted, then restart the robot; it must stand for that.
  restart(keep) {
    this.send({ do: "drive", what: "stop" });
    this.restarting = keep;
    if (keep) this.send({ do: "keep" });
    else this.start_anew();
  }

  // What was to be kept must have been kept before the robot forgets it.
  replied({ command, status }) {
    if (command !== "keep" || !this.restarting) return;
    this.restarting = false;
    if (status === "ok") this.start_anew();
  }

  start_anew() {
    setTimeout(() => this.send({ do: "restart" }), STAND_MS);
  }

  // What a Keep has done, in words.
  kept({ status, text, kept }) {
    const note = document.getElementById("kept");
    const what = [...this.unkept].map((one) => one.join(" ")).join(", ") || "nothing was changed since the last time";
    note.textContent = status === "ok" ? `Kept in ${kept}: ${what}.` : `Not kept: ${text || status}.`;
    note.className = status === "ok" ? "" : "trouble";
    note.hidden = false;
    if (status === "ok") this.unkept.clear();
  }

  show(parameter) {
    const parent = parameter.key.startsWith("servos.trims.") ? this.trims : this.box;
    const row = this.rows[parameter.key] || (this.rows[parameter.key] = this.build(parameter, parent));
    row.set(parameter.value);
    // Where the default goes with the body, what was there first stands for it.
    row.box.classList.toggle("changed", parameter.value !== (parameter.default ?? row.first));
    if (parameter.restart && parameter.value !== row.first) this.notice.hidden = false;
  }

  build({ key, low, high, unit, meaning, value, restart }, parent) {
    const box = document.createElement("div");
    box.className = "parameter";
    const label = document.createElement("label");
    label.textContent = key;
    const more = document.createElement("small");
    more.textContent = `${meaning} (${low} to ${high}${unit ? " " + unit : ""})${restart ? ", counts from the next start" : ""}`;
    label.append(more);
    const number = document.createElement("input");
    const slider = document.createElement("input");
    number.type = "number";
    slider.type = "range";
    number.id = `parameter-${key}`;
    label.htmlFor = number.id;
    slider.setAttribute("aria-label", key);
    for (const input of [number, slider]) {
      Object.assign(input, { min: low, max: high, step: key.startsWith("servos.trims.") ? 0.5 : 1, value });
      input.oninput = () => {
        if (input.value === "" || !input.checkValidity()) return;
        number.value = slider.value = input.value;
        this.tune(key, Number(input.value));
      };
    }
    box.append(label, number, slider);
    parent.append(box);
    const set = (value) => {
      if (document.activeElement !== number && document.activeElement !== slider) number.value = slider.value = value;
    };
    return { box, set, first: value };
  }

  // A slider makes dozens of values a second; the robot gets the last of each moment, so that a wheel turns as its trim is dragged.
  tune(key, value) {
    this.next[key] = value;
    this.unkept.set(key, value);
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
