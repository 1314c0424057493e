// The recordings at hand: length, result, and the robot's way as a small picture. A click opens one.

const SVG = "http://www.w3.org/2000/svg";
const clock = (seconds) => (seconds === null ? "" : `${Math.floor(seconds / 60)}:${(seconds % 60).toFixed(0).padStart(2, "0")}`);

export class Recordings {
  constructor(box, list, send) {
    Object.assign(this, { box, list, send });
    box.ontoggle = () => box.open && this.ask();
  }

  ask() {
    if (this.box.open) this.send({ do: "recordings" });
  }

  show(recordings) {
    this.list.replaceChildren(...recordings.map((one) => this.entry(one)));
    if (!recordings.length) this.list.textContent = "none yet";
  }

  entry({ path, length, result, way }) {
    const entry = document.createElement("li"), button = document.createElement("button"), words = document.createElement("span");
    const name = document.createElement("small");
    button.type = "button";
    name.textContent = path;
    words.append([clock(length), result].filter(Boolean).join(", "), name);
    button.append(picture(way), words);
    button.onclick = () => this.send({ do: "open", address: `file:${path}` });
    const beside = document.createElement("button");
    Object.assign(beside, { type: "button", textContent: "Beside", title: "show it beside what is open" });
    beside.setAttribute("aria-label", `show ${path} beside what is open`);
    beside.onclick = () => this.send({ do: "compare", path });
    entry.append(button, beside);
    return entry;
  }
}

// The way, north up, from a dot at its start.
function picture(way) {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("aria-hidden", "true");
  if (!way.length) return svg;
  const xs = way.map(([x]) => x), ys = way.map(([, y]) => -y);
  const left = Math.min(...xs), top = Math.min(...ys), size = Math.max(Math.max(...xs) - left, Math.max(...ys) - top, 300);
  const room = size * 0.1;
  svg.setAttribute("viewBox", `${left - room} ${top - room} ${Math.max(...xs) - left + 2 * room || 1} ${Math.max(...ys) - top + 2 * room || 1}`);
  const line = document.createElementNS(SVG, "polyline"), dot = document.createElementNS(SVG, "circle");
  line.setAttribute("points", way.map(([x, y]) => `${x},${-y}`).join(" "));
  line.setAttribute("style", "fill: none; stroke: var(--chosen); stroke-width: 2px; vector-effect: non-scaling-stroke");
  for (const [key, value] of Object.entries({ cx: way[0][0], cy: -way[0][1], r: size * 0.04, fill: "var(--text)" })) dot.setAttribute(key, value);
  svg.append(line, dot);
  return svg;
}
