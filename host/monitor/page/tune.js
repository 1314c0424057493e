// Every live parameter with its unit, range and meaning; servo trims, with the wheel turning as one drags.

const PERIOD_MS = 120;
const SETTLE_MS = 500;
// The robot stands still for each new value of these: it gets the one at which the slider comes to rest.
const TABLES = ["avoid.margin", "avoid.soft_margin", "windows.look_ahead"];

export class Tune {
  constructor(box, trims, send) {
    Object.assign(this, { box, trims, send });
    this.rows = {};
    this.next = {};
    this.busy = {};
    this.settle = null;
  }

  clear() {
    this.box.replaceChildren();
    this.trims.replaceChildren();
    this.rows = {};
  }

  show(parameter) {
    const parent = parameter.key.startsWith("servos.trims.") ? this.trims : this.box;
    const row = this.rows[parameter.key] || (this.rows[parameter.key] = this.build(parameter, parent));
    row.set(parameter.value);
    // Where the default goes with the body, what was there first stands for it.
    row.box.classList.toggle("changed", parameter.value !== (parameter.default ?? row.first));
  }

  build({ key, low, high, unit, meaning, value }, parent) {
    const box = document.createElement("div");
    box.className = "parameter";
    const label = document.createElement("label");
    label.textContent = key;
    const more = document.createElement("small");
    more.textContent = `${meaning} (${low} to ${high}${unit ? " " + unit : ""})`;
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
    if (!TABLES.includes(key) && !this.busy[key]) this.tell(key);
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
      if (!TABLES.includes(key)) this.tell(key);
    }, PERIOD_MS);
  }
}
