// The twin: which course, with what failing, how fast, and a box in the robot's way.

import { choices, isOn, toggle } from "./choices.js";

const SVG = "http://www.w3.org/2000/svg";
const SPEEDS = [[0.1, "⅒×"], [0.25, "¼×"], [0.5, "½×"], [1, "1×"], [4, "4×"], [16, "16×"]];
const BOX = 200; // mm
const FORM = `
  <h3>Time</h3>
  <p class="tools"><button type="button" data-id="pause">Pause</button> <button type="button" data-id="step">One decision</button>
    <span class="tools" role="radiogroup" aria-label="speed, times real time" data-id="speeds"></span></p>
  <h3>A box in its way</h3>
  <p class="tools"><button type="button" data-id="box" aria-pressed="false">Box</button> <label>size <input type="number" data-id="box-size" min="40" max="400" step="10" value="${BOX}"> mm</label>
    <small>drag it on the map from above, while the robot drives</small></p>
  <form data-id="form">
    <h3>Another run</h3>
    <div class="courses" role="radiogroup" aria-label="course" data-id="courses"></div>
    <p class="fields">
      <label><span data-id="size-name">width</span> <input type="number" data-id="size" step="10"> mm</label>
      <label>seed <input type="number" data-id="seed" min="0" step="1" value="0"></label>
      <label>wheels <select data-id="mode"><option value="">as in robot.json</option><option value="aws">all steered</option><option value="naws">last axle straight</option></select></label>
      <label>screen <select data-id="screen"><option value="">as in robot.json</option><option>usart-gpu</option><option>uart-lcd</option><option>nextion</option></select></label>
      <label>fails <select data-id="fault"><option value="">nothing</option></select></label>
      <label>after <input type="number" data-id="after" min="0" max="3599" step="0.5" placeholder="4"> s</label>
      <button type="button" data-id="mirror" aria-pressed="false">Mirrored</button>
      <button type="button" data-id="reverse" aria-pressed="false">From the other end</button>
      <button type="button" data-id="record" aria-pressed="false" title="into out/, from the start, so that the firmware can drive it again">Recorded</button>
      <button class="main">Drive</button>
    </p>
    <p class="trouble" role="alert" data-id="trouble" hidden></p>
  </form>`;

export const twin = {
  id: "twin",
  title: "Twin",
  shown: () => twin.there,
  there: false,

  build(box, page) {
    this.page = page;
    box.innerHTML = FORM;
    this.get = (id) => box.querySelector(`[data-id="${id}"]`);
    const { get } = this, { send, state } = page;
    get("pause").onclick = () => send({ do: "pace", paused: !state.pace?.paused });
    get("step").onclick = () => send({ do: "pace", step: true });
    this.speed = choices(get("speeds"), SPEEDS, 1, (speed) => send({ do: "pace", speed }));
    toggle(get("box"), (on) => this.place(on ? Number(get("box-size").value) : 0));
    get("box-size").onchange = () => isOn(get("box")) && this.place(Number(get("box-size").value));
    for (const id of ["mirror", "reverse", "record"]) toggle(get(id), () => {});
    get("form").onsubmit = (event) => {
      event.preventDefault();
      this.drive();
    };
  },

  hear: {
    connected({ address }) { twin.open(address); },
    courses(message) { twin.offer(message); },
    pace({ paused, speed }) {
      twin.get("pause").textContent = paused ? "Go on" : "Pause";
      twin.get("pause").classList.toggle("on", paused);
      twin.speed(speed);
    },
    box({ size }) { twin.get("box").setAttribute("aria-pressed", size > 0); },
    refused(message) {
      if (message.do === "again") twin.trouble(message.text);
    },
    ended() {
      for (const id of ["pause", "step", "box"]) twin.get(id).disabled = true;
    },
  },

  open(address) {
    this.there = address.startsWith("twin:");
    this.trouble("");
    if (!this.there) return;
    const [place, query] = address.slice("twin:".length).split("?"), given = new URLSearchParams(query);
    Object.assign(this, { course: place.toLowerCase(), given });
    this.get("box").setAttribute("aria-pressed", false);
    for (const id of ["pause", "step", "box"]) this.get(id).disabled = false;
    this.get("seed").value = given.get("seed") || 0;
    this.get("screen").value = given.get("screen") || "";
    this.get("mode").value = (given.get("mode") || "").toLowerCase();
    for (const id of ["mirror", "reverse"]) this.get(id).setAttribute("aria-pressed", given.get(id) === "1");
    if (this.offered) this.choose();
    else this.page.send({ do: "courses" });
  },

  // Courses, each with a small picture of its walls.
  offer({ list, faults }) {
    this.offered = list;
    this.chooses = choices(this.get("courses"), list.map(({ name }) => [name.toLowerCase(), name]), "", (name) => this.choose(name));
    list.forEach(({ walls }, k) => this.get("courses").children[k].prepend(picture(walls)));
    this.get("fault").append(...faults.map(({ name, text }) => Object.assign(new Option(name, name), { title: text })));
    this.choose();
  },

  choose(name = this.course) {
    this.course = name;
    this.chooses(name);
    const [what, low, high, usual] = this.offered.find((one) => one.name.toLowerCase() === name)?.size || ["width", 260, 3000, 550];
    this.size = what;
    this.get("size-name").textContent = what;
    Object.assign(this.get("size"), { min: low, max: high, value: this.given.get(what) || usual });
    const [fault, after] = (this.given.get("fault") || "").split("@");
    this.get("fault").value = fault;
    this.get("after").value = after || "";
  },

  drive() {
    const { get } = this, fault = get("fault").value, after = get("after").value;
    const course = this.offered.find((one) => one.name.toLowerCase() === this.course)?.name;
    this.trouble("");
    this.page.send({
      do: "again", course, [this.size]: get("size").value, seed: get("seed").value, mode: get("mode").value, screen: get("screen").value, fault: fault && after ? `${fault}@${after}` : fault,
      mirror: isOn(get("mirror")) ? 1 : "", reverse: isOn(get("reverse")) ? 1 : "", record: isOn(get("record")),
    });
  },

  // A box ahead of the robot's nose, to begin with; or where it is.
  place(size) {
    const { box, truth, hello } = this.page.state;
    if (!truth) return;
    const heading = truth.heading * Math.PI / 180, far = (hello?.length || 600) / 2 + 500;
    const at = box?.size ? box : { x: truth.x + far * Math.sin(heading), y: truth.y + far * Math.cos(heading) };
    this.page.send({ do: "box", x: at.x, y: at.y, size });
  },

  trouble(text) {
    this.get("trouble").textContent = text;
    this.get("trouble").hidden = !text;
  },
};

function picture(walls) {
  const svg = document.createElementNS(SVG, "svg"), path = document.createElementNS(SVG, "path");
  const xs = walls.flatMap(([x1, , x2]) => [x1, x2]), ys = walls.flatMap(([, y1, , y2]) => [-y1, -y2]);
  const left = Math.min(...xs), top = Math.min(...ys);
  svg.setAttribute("viewBox", `${left - 80} ${top - 80} ${Math.max(...xs) - left + 160} ${Math.max(...ys) - top + 160}`);
  svg.setAttribute("aria-hidden", "true");
  path.setAttribute("d", walls.map(([x1, y1, x2, y2]) => `M${x1},${-y1}L${x2},${-y2}`).join(""));
  svg.append(path);
  return svg;
}
