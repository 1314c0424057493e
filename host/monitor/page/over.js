// A run that is over: why, and how to drive again, with a choice of course.

const VERBS = "#auto, #manual, #stop, #record";
const CARDS = "#drive-card button, #drive-card input, #panel-tune button, #panel-tune input";
const SIZES = { width: [260, 3000, 550], gap: [100, 1500, 500] };

export class Over {
  constructor(send) {
    const get = (id) => document.getElementById(id);
    Object.assign(this, { get, send });
    get("course").onchange = () => this.size();
    get("over").onsubmit = (event) => {
      event.preventDefault();
      const command = { do: "again" };
      if (!get("choice").hidden) Object.assign(command, { course: get("course").value, [this.name]: get("size").value, seed: get("seed").value });
      send(command);
    };
  }

  connected({ address, courses }) {
    const { get } = this;
    get("over").hidden = true;
    document.querySelector("main").classList.remove("over");
    for (const one of document.querySelectorAll(CARDS)) one.disabled = false;
    get("choice").hidden = !courses.length;
    if (!courses.length) return;
    const [place, query] = address.slice("twin:".length).split("?");
    this.given = new URLSearchParams(query);
    get("course").replaceChildren(...courses.map((name) => new Option(name, name, false, name.toLowerCase() === place.toLowerCase())));
    get("seed").value = this.given.get("seed") || 0;
    this.size();
  }

  // The passages have a width, random has gaps between its boxes.
  size() {
    const { get } = this;
    this.name = get("course").value === "random" ? "gap" : "width";
    const [low, high, usual] = SIZES[this.name];
    get("size-name").textContent = this.name;
    Object.assign(get("size"), { min: low, max: high, value: this.given.get(this.name) || usual });
  }

  // commands: whether it was driven at all; a recording has its own way of being over.
  ended(text, commands) {
    if (!commands) return;
    const { get } = this;
    for (const one of document.querySelectorAll(`${VERBS}, ${CARDS}`)) one.disabled = true;
    document.querySelector("main").classList.add("over");
    get("drive-again").textContent = get("choice").hidden ? "Connect again" : "Drive again";
    get("over-text").textContent = text;
    get("over").hidden = false;
  }

  refused(text) {
    this.get("over-text").textContent = text;
  }
}
