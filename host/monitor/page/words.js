// The state in words and figures: the head of the page, and the lines under the maps.

import { Figures } from "./figures.js";

const SILENT_MS = 2000;
const get = (id) => document.getElementById(id);

export class Words {
  // charts: for nothing but the reason's name. live: the connection; hand: who drives.
  constructor(state, live, hand) {
    Object.assign(this, { state, live, hand });
    this.numbers = new Figures(get("numbers"), [["AF", "°", 5], ["AR", "°", 5], ["V", "", 3], ["mode", "", 1], ["free", " mm", 4], ["", " mm/s", 3]]);
    this.place = new Figures(get("place"), [["x", "", 5], ["y", " mm", 5], ["heading", "°", 3], ["clearance", " mm", 4]]);
  }

  why(row) {
    return this.state.names?.reasons?.[row.why] || "";
  }

  // What the robot is doing: [name, reason].
  now(heard) {
    const { state, live } = this;
    const { decision } = state;
    if (state.ended) return ["ended", get("over").hidden ? state.ended : ""]; // which says it
    if (!live.socket) return ["no monitor", "the monitor has been closed, or its network is gone"];
    if (state.pace?.paused) return ["paused", "the twin stands still in time: go on, or step by step, on its panel"];
    if (state.commands && heard && performance.now() - heard > SILENT_MS) return ["silent", "nothing heard from the robot"];
    if (state.health?.fault) return ["fault", state.names?.faults?.[state.health.fault] || `fault ${state.health.fault}`];
    return [decision?.state || "connecting", decision ? this.why(decision) : ""];
  }

  show(heard) {
    const { state, hand } = this;
    const [name, reason] = this.now(heard);
    const pill = get("state");
    // After power-up it waits for a person.
    const waits = name === "waiting";
    get("auto").classList.toggle("main", waits);
    put(get("auto").firstChild, waits ? "Start " : "Auto ");
    if (pill.textContent !== name) {
      pill.textContent = name;
      pill.className = `pill ${name}`;
    }
    if (get("reason").textContent !== reason) get("reason").textContent = reason;
    get("manual").classList.toggle("on", hand.active);
    document.body.classList.toggle("by-hand", hand.active);
    const { decision, wheels } = state;
    const speed = wheels ? Math.round(Math.max(...wheels.speeds.map(Math.abs))) : null;
    if (decision) this.numbers.show(decision.af.toFixed(1), decision.ar.toFixed(1), decision.v, decision.mode, decision.free, speed);
    const at = state.truth || state.pose;
    if (at) this.place.show(Math.round(at.x), Math.round(at.y), Math.round(at.heading), state.truth?.clearance == null ? null : Math.round(state.truth.clearance));
  }
}

function put(node, text) {
  if (node.data !== text) node.data = text;
}
