// Driving by hand: keys, stick, gamepad, levers. Sends as long as it is in charge; what is not sent, the robot takes for a stop.

const PERIOD_MS = 80;
const LOCK = 60; // degrees of full steering

// What the stick's x (-1 left .. 1 right) and y (-1 back .. 1 ahead) mean in each mode of the steering.
export const MODES = [
  { name: "1 adverse phase", steer: (x, y) => [LOCK * x, -LOCK * x, y] },
  { name: "2 first axle straight", steer: (x, y) => [0, -LOCK * x, y] },
  { name: "3 last axle straight", steer: (x, y) => [LOCK * x, 0, y] },
  { name: "4 spin on the spot", steer: (x) => [90, -90, x] },
  { name: "5 lateral", steer: (x, y) => crab(x, y) },
  { name: "AF, AR, V", steer: null },
];

// The way the stick points, folded into wheels that turn by 90 degrees at most.
function crab(x, y) {
  const size = Math.min(Math.hypot(x, y), 1);
  if (size < 0.05) return [0, 0, 0];
  let angle = Math.atan2(x, y) * 180 / Math.PI, speed = size;
  if (Math.abs(angle) > 90) {
    angle -= Math.sign(angle) * 180;
    speed = -speed;
  }
  return [angle, angle, speed];
}

export class Hand {
  // send(command), stop(), auto(): what the buttons of a gamepad do. pads: Pads.
  constructor(state, send, stop, auto, pads) {
    Object.assign(this, { state, send, stop, auto });
    this.active = false;
    this.mode = 0;
    this.keys = new Set();
    this.stick = { x: 0, y: 0 };
    this.pads = pads;
    this.build();
    setInterval(() => this.tick(), PERIOD_MS);
  }

  build() {
    const box = document.getElementById("modes");
    MODES.forEach((mode, i) => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = mode.name;
      button.setAttribute("role", "radio");
      button.onclick = () => this.choose(i);
      box.append(button);
    });
    this.choose(0);
    const stick = document.getElementById("stick");
    // On a phone it lies over the map while somebody drives by hand.
    const phone = matchMedia("(max-width: 699px), (max-height: 559px)");
    const lay = () => (phone.matches ? document.getElementById("stage") : document.getElementById("hand")).prepend(stick);
    phone.onchange = lay;
    lay();
    const move = (event) => {
      const box = stick.getBoundingClientRect();
      const x = (event.clientX - box.left) / box.width * 2 - 1, y = 1 - (event.clientY - box.top) / box.height * 2;
      const size = Math.max(1, Math.hypot(x, y));
      this.stick = { x: x / size, y: y / size };
      this.take();
    };
    stick.onpointerdown = (event) => {
      stick.setPointerCapture(event.pointerId);
      move(event);
    };
    stick.onpointermove = (event) => {
      if (stick.hasPointerCapture(event.pointerId)) move(event);
    };
    stick.onpointerup = stick.onpointercancel = stick.onlostpointercapture = () => { this.stick = { x: 0, y: 0 }; };
    this.levers = Object.fromEntries(["af", "ar", "v", "top"].map((name) => [name, document.getElementById(name)]));
    for (const [name, lever] of Object.entries(this.levers)) {
      lever.oninput = () => {
        document.getElementById(`${name}-now`).textContent = lever.value;
        if (name === "top") return;
        this.choose(MODES.length - 1);
        this.take();
      };
      // A lever of speed springs back, or a robot would drive on with nobody's hand on it.
      if (name === "v") lever.onpointerup = lever.onpointercancel = lever.onlostpointercapture = lever.onkeyup = lever.onblur = () => this.set("v", 90);
    }
    addEventListener("blur", () => this.letGo());
    document.addEventListener("visibilitychange", () => document.hidden && this.letGo());
  }

  set(name, value) {
    this.levers[name].value = value;
    document.getElementById(`${name}-now`).textContent = Math.round(value);
  }

  choose(mode) {
    this.mode = mode;
    [...document.getElementById("modes").children].forEach((button, i) => button.setAttribute("aria-checked", i === mode));
  }

  take() {
    if (this.state.ended) return; // nobody is there to be driven
    if (!this.active) this.since = performance.now();
    this.active = true;
  }

  // In charge for long enough that the robot must have heard.
  longActive() {
    return this.active && performance.now() - this.since > 1000;
  }

  // Nothing is held any more, as far as this page can know.
  letGo() {
    this.keys.clear();
    this.stick = { x: 0, y: 0 };
    this.set("v", 90);
  }

  release() {
    this.active = false;
    this.letGo();
  }

  key(code, down) {
    if (!code.startsWith("Arrow")) return false;
    if (down) {
      this.keys.add(code);
      this.take();
    } else {
      this.keys.delete(code);
    }
    return true;
  }

  input() {
    let { x, y } = this.stick;
    const held = (code) => (this.keys.has(code) ? 1 : 0);
    x += held("ArrowRight") - held("ArrowLeft");
    y += held("ArrowUp") - held("ArrowDown");
    // A page that nobody looks at has no hand at the pad either.
    const seen = !document.hidden && (document.hasFocus?.() ?? true);
    const pads = this.pads.read(seen ? navigator.getGamepads?.() || [] : [], performance.now());
    if (pads.x || pads.y) this.take();
    this.buttons(pads.uses);
    x += pads.x;
    y += pads.y;
    const clip = (value) => Math.max(-1, Math.min(1, value));
    return { x: clip(x), y: clip(y) };
  }

  buttons(uses) {
    if (uses.includes("stop")) this.stop();
    else if (uses.includes("auto")) this.auto();
    if (uses.includes("previous")) this.choose((this.mode + 4) % 5);
    if (uses.includes("next")) this.choose((this.mode + 1) % 5);
  }

  tick() {
    const { x, y } = this.input();
    const knob = document.querySelector("#stick i");
    knob.style.transform = `translate(${x * 90}%, ${-y * 90}%)`;
    if (!this.active) return;
    let af = Number(this.levers.af.value), ar = Number(this.levers.ar.value), v = Number(this.levers.v.value);
    const { steer } = MODES[this.mode];
    if (steer) {
      const [front, rear, speed] = steer(x, y);
      [af, ar, v] = [front, rear, 90 + speed * Number(this.levers.top.value)];
      this.set("af", af);
      this.set("ar", ar);
      document.getElementById("v-now").textContent = Math.round(v);
    }
    this.send({ do: "drive", what: "manual", af, ar, v });
  }
}
