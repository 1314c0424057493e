// The trim of each servo: the body from above with its wheels, the one that is trimmed marked, each turned as its trim says.

import { bodyOf, wheels } from "./geometry.js";

const SVG = "http://www.w3.org/2000/svg";

export class Trims {
  constructor(box, change) {
    Object.assign(this, { box, change });
    this.clear();
  }

  clear() {
    this.box.replaceChildren();
    this.rows = {};
    this.picture = null;
  }

  show(parameter, hello) {
    const wheel = Number(parameter.key.split(".").pop());
    if (!this.picture) this.draw(hello);
    const row = this.rows[parameter.key] || (this.rows[parameter.key] = this.build(parameter, wheel));
    row.set(parameter.value);
  }

  draw(hello) {
    const body = bodyOf(hello), svg = make("svg", { viewBox: `${-body.width} ${-body.length / 2 - 20} ${2 * body.width} ${body.length + 40}`, "aria-hidden": "true" });
    svg.append(make("rect", { x: -body.width / 2, y: -body.length / 2, width: body.width, height: body.length, rx: 20, class: "body" }));
    this.wheels = wheels(body).map(({ x, y }) => {
      const group = make("g", { transform: `translate(${x} ${-y})` });
      const wheel = make("rect", { x: -14, y: -36, width: 28, height: 72, rx: 8, class: "wheel" });
      group.append(make("line", { x1: 0, x2: 0, y1: -56, y2: 56, class: "axis" }), wheel);
      svg.append(group);
      return wheel;
    });
    const list = document.createElement("div");
    this.list = list;
    this.box.append(svg, list);
    this.picture = svg;
  }

  build({ key, low, high, value }, wheel) {
    const box = document.createElement("div"), name = `axle ${(wheel >> 1) + 1} ${wheel & 1 ? "right" : "left"}`;
    box.className = "trim";
    box.innerHTML = `<label></label><input type="number"><input type="range">`;
    const [label, number, slider] = box.children;
    label.textContent = name;
    label.htmlFor = number.id = `parameter-${key}`;
    slider.setAttribute("aria-label", `trim of ${name}, degrees`);
    const turn = (angle) => {
      this.wheels[wheel]?.setAttribute("transform", `rotate(${angle})`);
      box.classList.toggle("changed", angle !== 0);
    };
    for (const input of [number, slider]) {
      Object.assign(input, { min: low, max: high, step: 0.5, value });
      input.title = `${low} to ${high} degrees, clockwise`;
      input.oninput = () => {
        const wrong = input.value === "" || !input.checkValidity();
        number.setAttribute("aria-invalid", wrong);
        if (wrong) return;
        number.value = slider.value = input.value;
        turn(Number(input.value));
        this.change(key, Number(input.value));
      };
      input.onfocus = () => this.wheels[wheel]?.classList.add("marked");
      input.onblur = () => this.wheels[wheel]?.classList.remove("marked");
    }
    this.list.append(box);
    const set = (now) => {
      if (document.activeElement === number || document.activeElement === slider) return;
      number.value = slider.value = now;
      turn(now);
    };
    return { set };
  }
}

function make(name, attributes) {
  const node = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  return node;
}
