// The page: hands every message to the parts that show it, and every wish to the robot.

import { Charts } from "./charts.js";
import { Dials } from "./dials.js";
import { Hand } from "./drive.js";
import { Health } from "./health.js";
import { Live } from "./live.js";
import { HeadUp } from "./map.js";
import { Motion } from "./motion.js";
import { Over } from "./over.js";
import { Panels } from "./panels.js";
import { Player } from "./player.js";
import { Recordings } from "./recordings.js";
import { colours, onTheme } from "./theme.js";
import { Tune } from "./tune.js";
import { World } from "./world.js";

const get = (id) => document.getElementById(id);
const pressed = (id) => get(id).getAttribute("aria-pressed") === "true";
const SILENT_MS = 2000;

// The latest message of each type, by its type; and the parameters.
const state = {
  parameters: {},
  parameter(key, otherwise) {
    return this.parameters[key]?.value ?? otherwise;
  },
};

const motion = new Motion();
const map = new HeadUp(get("map"), state, motion);
const world = new World(get("world"), state);
const charts = new Charts(get("charts"));
const dials = new Dials(get("dials"));
const health = new Health(get("health"), get("log"));
const send = (command) => live.send(command);
const player = new Player(send);
const recordings = new Recordings(get("recordings"), get("recorded"), send);
const over = new Over(send);
const tune = new Tune(get("parameters"), get("trims"), get("next-start"), send);
const hand = new Hand(state, send, stop, auto);
let heard = 0;
let session = null;
let changed = true;
const redraw = () => { changed = true; };

// What the modules of further panels get: see panels.js.
const page = { state, send, redraw, colours, say: (text) => health.say(text) };
const panels = new Panels(page, state);
Object.assign(map, { panels });
Object.assign(world, { panels });

// What is told once for each side, parameter or occasion is kept elsewhere, or not at all.
const PASSING = ["connected", "candidates", "parameter", "reply", "refused", "log", "text", "event", "recording", "recordings", "jump", "ended"];

const HEAR = {
  connected(message) {
    for (const kind of Object.keys(state)) if (kind !== "parameter") delete state[kind];
    state.parameters = {};
    tune.clear();
    world.clear();
    motion.clear();
    charts.clear();
    hand.release();
    session = null;
    state.ended = null;
    over.connected(message);
    player.connected(message);
    state.commands = message.commands;
  },
  jump() {
    world.clear();
    motion.clear();
    charts.clear();
  },
  hello(message) {
    document.title = `${message.robot} – Gapseeker`;
    if (message.session === session) return;
    // Another robot, or the same one restarted: it knows nothing of what this page wants.
    if (session) tune.clear();
    session = message.session;
    watch();
  },
  decision(message) {
    charts.note(message);
    // Another page, the screen or the robot itself may have taken over.
    if (message.state !== "manual" && hand.longActive()) hand.release();
  },
  wheels(message) { dials.show(message); },
  truth(message) { world.note(message); },
  pose(message) {
    world.note(message);
    motion.note(message);
  },
  health(message) { health.show(message, state.names?.faults); },
  parameter(message) {
    state.parameters[message.key] = message;
    tune.show(message);
  },
  candidates(message) {
    // Left and right are told in turn.
    const other = message.side === "left" ? "right" : "left";
    const known = state.candidates?.[other];
    state.candidates = { [message.side]: message };
    if (known && known.backward === message.backward) state.candidates[other] = known;
  },
  recording(message) {
    player.recording(message.path, message.saved);
    if (message.saved) recordings.ask();
  },
  recordings(message) { recordings.show(message.list); },
  playback(message) { player.playback(message); },
  reply(message) {
    if (message.command === "keep") tune.kept(message);
    if (message.status !== "ok" || message.text) health.say(`${message.command}: ${message.text || message.status}`);
    tune.replied(message);
  },
  refused(message) {
    health.say(message.text);
    if (message.do === "open") player.refused(message.text);
    if (message.do === "again") over.refused(message.text);
  },
  log(message) { health.say(message.text); },
  text(message) { health.say(message.text); },
  event(message) { health.say(message.text); },
  ended(message) {
    state.ended = message.text;
    health.say(message.text);
    hand.release();
    over.ended(message.text, state.commands);
  },
};

const live = new Live((message) => {
  if (!PASSING.includes(message.type)) state[message.type] = message;
  HEAR[message.type]?.(message);
  panels.hear(message);
  heard = performance.now();
  changed = true;
}, () => {
  hand.release();
  state.lost = true;
  changed = true;
});

function stop() {
  hand.release();
  send({ do: "drive", what: "stop" });
}

function auto() {
  hand.release();
  send({ do: "drive", what: "auto" });
}

function manual() {
  if (state.ended) return;
  hand.take();
}

get("stop").onclick = stop;
get("auto").onclick = auto;
get("manual").onclick = manual;
get("keep").onclick = () => send({ do: "keep" });
get("keep-restart").onclick = () => tune.restart(true);
get("restart").onclick = () => tune.restart(false);
// Switches are buttons: the space bar, which turns a tick box, stops the robot here.
for (const id of ["scan", "candidates", "legend"]) {
  get(id).onclick = () => {
    get(id).setAttribute("aria-pressed", !pressed(id));
    if (id === "legend") get("legend-box").hidden = !pressed(id);
    else if (!pressed(id)) delete state[id];
    if (id !== "legend") watch();
    redraw();
  };
}

function watch() {
  if (state.commands) send({ do: "watch", scan: pressed("scan"), candidates: pressed("candidates") });
}

// Which map is seen where there is room for one.
for (const [view, title] of [["robot", "Round the robot"], ["world", "From above"]]) {
  const button = document.createElement("button");
  Object.assign(button, { type: "button", textContent: title });
  button.setAttribute("role", "radio");
  button.setAttribute("aria-checked", view === "robot");
  button.onclick = () => {
    get("stage").dataset.view = view;
    for (const one of get("views").children) one.setAttribute("aria-checked", one === button);
    redraw();
  };
  get("views").append(button);
}

// Elements that the arrow keys belong to.
const ARROWS = "input, select, [role=tab], [role=img]";

addEventListener("keydown", (event) => {
  const writing = event.target.matches("input:not([type=range]):not([type=checkbox]), select");
  // The space bar stops wherever the focus is: nothing here needs a space typed.
  if (event.code === "Space") {
    event.preventDefault();
    if (!event.repeat) stop();
  } else if (writing || event.ctrlKey || event.metaKey || event.altKey || !state.commands || state.ended) {
    return;
  } else if (!event.target.matches(ARROWS) && hand.key(event.code, true)) {
    event.preventDefault();
  } else if (event.code === "KeyA") {
    auto();
  } else if (event.code === "KeyM") {
    manual();
  } else if (/^Digit[1-5]$/.test(event.code)) {
    hand.choose(Number(event.code.slice(5)) - 1);
  }
}, true);
addEventListener("keyup", (event) => {
  if (event.code === "Space") event.preventDefault();
  hand.key(event.code, false);
}, true);

function words() {
  const decision = state.decision;
  const pill = get("state");
  let name = decision?.state || "connecting", reason = "";
  if (state.ended) {
    name = "ended";
    reason = get("over").hidden ? state.ended : ""; // which says it
  } else if (!live.socket) {
    name = "no monitor";
    reason = "the monitor has been closed, or its network is gone";
  } else if (state.commands && heard && performance.now() - heard > SILENT_MS) {
    name = "silent";
    reason = "nothing heard from the robot";
  } else if (state.health?.fault) {
    name = "fault";
    reason = state.names?.faults?.[state.health.fault] || `fault ${state.health.fault}`;
  } else if (decision) {
    reason = state.names?.reasons?.[decision.why] || "";
  }
  // After power-up it waits for a person.
  const waits = name === "waiting";
  get("auto").classList.toggle("main", waits);
  get("auto").firstChild.data = waits ? "Start " : "Auto ";
  pill.textContent = name;
  pill.className = `pill ${name}`;
  get("reason").textContent = reason;
  get("manual").classList.toggle("on", hand.active);
  if (decision) {
    const speed = state.wheels ? Math.max(...state.wheels.speeds.map(Math.abs)) : 0;
    get("numbers").textContent = `AF ${decision.af}° AR ${decision.ar}° V ${decision.v}, mode ${decision.mode}, free ${decision.free} mm, ${Math.round(speed)} mm/s`;
  }
  const place = state.truth || state.pose;
  if (place) {
    get("place").textContent = `x ${Math.round(place.x)} y ${Math.round(place.y)} mm, heading ${Math.round(place.heading)}°`
      + (state.truth?.clearance != null ? `, clearance ${Math.round(state.truth.clearance)} mm` : "");
  }
}

let drawn = 0;
function draw() {
  if (changed) {
    changed = false;
    map.draw();
    world.draw();
    charts.draw();
    document.body.dataset.drawn = ++drawn;
  }
  words();
  requestAnimationFrame(draw);
}
const sized = new ResizeObserver(redraw);
for (const id of ["map", "world", "charts"]) sized.observe(get(id));
onTheme(redraw);
draw();
