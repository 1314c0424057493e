// A dial for each wheel: its angle, and the speed it rolls with.

const SVG = "http://www.w3.org/2000/svg";

export class Dials {
  constructor(box) {
    this.box = box;
    this.dials = [];
  }

  show(wheels) {
    if (this.dials.length !== wheels.angles.length) this.build(wheels.angles.length);
    wheels.angles.forEach((angle, k) => {
      const { needle, text } = this.dials[k];
      const speed = wheels.speeds[k];
      needle.setAttribute("transform", `rotate(${angle} 20 20)`);
      needle.setAttribute("fill", Math.abs(speed) < 3 ? "var(--faint)" : "var(--edge)");
      text.textContent = `${angle.toFixed(1)}°  ${Math.round(speed)} mm/s`;
    });
  }

  build(count) {
    this.box.replaceChildren();
    this.dials = Array.from({ length: count }, (_, k) => {
      const box = document.createElement("div");
      box.className = "dial";
      const svg = document.createElementNS(SVG, "svg");
      svg.setAttribute("viewBox", "0 0 40 40");
      svg.setAttribute("aria-hidden", "true"); // the words beside it say it
      const ring = document.createElementNS(SVG, "circle");
      Object.entries({ cx: 20, cy: 20, r: 18, fill: "none", stroke: "var(--line)", "stroke-width": 2 }).forEach(([n, v]) => ring.setAttribute(n, v));
      const needle = document.createElementNS(SVG, "rect");
      Object.entries({ x: 15, y: 5, width: 10, height: 30, rx: 3 }).forEach(([n, v]) => needle.setAttribute(n, v));
      svg.append(ring, needle);
      const text = document.createElement("output");
      text.dataset.wheel = k;
      const label = document.createElement("span");
      label.innerHTML = `<small>axle ${(k >> 1) + 1} ${k & 1 ? "right" : "left"}</small><br>`;
      label.append(text);
      box.append(svg, label);
      this.box.append(box);
      return { needle, text };
    });
  }
}
