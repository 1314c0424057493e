// The page: hands every message to the parts that show it, and every wish to the robot.

import { Beside } from "./beside.js";
import { Charts, stops } from "./charts.js";
import { choices, isOn, toggle } from "./choices.js";
import { Dials } from "./dials.js";
import { Hand } from "./drive.js";
import { Health } from "./health.js";
import { listen } from "./keys.js";
import { Live } from "./live.js";
import { legend } from "./marks.js";
import { Motion } from "./motion.js";
import { Over } from "./over.js";
import { Pads } from "./pads.js";
import { Panels } from "./panels.js";
import { Player } from "./player.js";
import { Recordings } from "./recordings.js";
import { RobotMap } from "./robotmap.js";
import { colours, onTheme } from "./theme.js";
import { tip } from "./tip.js";
import { Tune } from "./tune.js";
import { Turns } from "./turns.js";
import { Words } from "./words.js";
import { WorldMap } from "./worldmap.js";

const get = (id) => document.getElementById(id);

// The latest message of each type, by its type; and the parameters.
const state = {
  parameters: {},
  parameter(key, otherwise) {
    return this.parameters[key]?.value ?? otherwise;
  },
};
// What is told once for each side, parameter or occasion is kept elsewhere, or not at all.
const PASSING = ["connected", "candidates", "parameter", "reply", "refused", "log", "text", "event", "recording", "recordings", "jump", "ended"];

let heard = 0, session = null, changed = true, drawn = 0;
const redraw = () => { changed = true; };
const send = (command) => live.send(command);
const motion = new Motion();
const map = new RobotMap(get("map"), state, motion, redraw, tip(get("map")));
const DRAG_MS = 100;
let dragged = 0;
const world = new WorldMap(get("world"), state, redraw, tip(get("world")), (box, done) => {
  state.box = box;
  if (!done && performance.now() - dragged < DRAG_MS) return;
  dragged = performance.now();
  send({ do: "box", x: box.x, y: box.y, size: box.size });
});
const charts = new Charts(get("charts"), redraw, tip(get("charts")), (row) => words.why(row), (at) => player.seek(at));
const dials = new Dials(get("dials"));
const health = new Health(get("health"), get("log"));
const turns = new Turns(get("turns-box"));
const player = new Player(send);
const recordings = new Recordings(get("recordings"), get("recorded"), send);
const over = new Over(send);
const beside = new Beside(send, { charts, world });
const tune = new Tune(send, state);

function stop() {
  hand.release();
  send({ do: "drive", what: "stop" });
}

function auto() {
  hand.release();
  send({ do: "drive", what: "auto" });
}

function manual() {
  if (!state.ended) hand.take();
}

const pads = new Pads();
const hand = new Hand(state, send, stop, auto, pads);
// What the modules of further panels get: see panels.js.
const page = { state, send, redraw, colours, pads, say: (text) => health.say(text) };
const panels = new Panels(page, state);
map.panels = world.panels = panels;

const HEAR = {
  connected(message) {
    for (const kind of Object.keys(state)) if (kind !== "parameter") delete state[kind];
    state.parameters = {};
    for (const part of [tune, world, motion, charts, map, beside]) part.clear();
    hand.release();
    session = null;
    state.ended = null;
    over.connected(message);
    player.connected(message);
    state.commands = message.commands;
  },
  jump() {
    for (const part of [world, motion, map]) part.clear();
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
    world.stopped(message, words.why(message));
    // Another page, the screen or the robot itself may have taken over.
    if (message.state !== "manual" && hand.longActive()) hand.release();
  },
  points(message) { map.note(message); },
  wheels(message) { dials.show(message); },
  truth(message) { world.note(message); },
  pose(message) {
    world.note(message);
    motion.note(message);
  },
  health(message) { health.show(message, state.names?.faults); },
  turns(message) { turns.show(message); },
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
  run(message) { beside.whole(message); },
  other(message) { beside.also(message); },
  recordings(message) { recordings.show(message.list); },
  playback(message) {
    player.playback(message);
    charts.cursor = message.position;
  },
  reply(message) {
    if (message.command === "keep") tune.kept(message);
    if (message.status !== "ok" || message.text) health.say(`${message.command}: ${message.text || message.status}`);
    tune.replied(message);
  },
  refused(message) {
    health.say(message.text);
    if (message.do === "open") player.refused(message.text);
    if (message.do === "run_again" || message.do === "compare") beside.say(message.text, true);
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
  redraw();
}, () => {
  hand.release();
  redraw();
});
const words = new Words(state, live, hand);

Object.assign(get("stop"), { onclick: stop });
Object.assign(get("auto"), { onclick: auto });
Object.assign(get("manual"), { onclick: manual });
get("keep").onclick = () => send({ do: "keep" });
get("keep-restart").onclick = () => tune.restart(true);
get("restart").onclick = () => tune.restart(false);
listen(hand, { stop, auto, manual }, () => state.commands && !state.ended);

for (const id of ["scan", "candidates"]) {
  toggle(get(id), (on) => {
    if (!on) delete state[id];
    watch();
    redraw();
  });
}
toggle(get("turns"), watch);
toggle(get("legend"), (on) => {
  get("legend-box").hidden = !on;
  legend(get("legend-box"));
});
toggle(get("ages"), (on) => {
  map.shown.ages = on;
  redraw();
});

function watch() {
  if (state.commands) send({ do: "watch", scan: isOn(get("scan")), candidates: isOn(get("candidates")), turns: isOn(get("turns")) });
}

choices(get("views"), [["robot", "Round the robot"], ["world", "From above"]], "robot", (view) => {
  get("stage").dataset.view = view;
  redraw();
});
const follows = choices(get("follows"), [["whole", "All"], ["follow", "Follow"]], "whole", (mode) => world.view.choose(mode));
world.view.changed = () => follows(world.view.mode);
get("nearer").onclick = () => world.view.zoom(1.4);
get("farther").onclick = () => world.view.zoom(1 / 1.4);
choices(get("spans"), [[10, "10 s"], [30, "30 s"], [120, "2 min"], [Infinity, "all"]], 30, (span) => {
  charts.span = span;
  charts.to(Infinity);
});
get("scroll").oninput = () => charts.to(Number(get("scroll").value));

function draw() {
  if (changed) {
    changed = false;
    beside.at(charts.cursor ?? charts.length, stops(charts.rows).map((one) => ({ ...one, text: words.why(one) })));
    map.draw();
    world.draw();
    charts.draw();
    Object.assign(get("scroll"), { min: Math.min(charts.shown, charts.length), max: charts.length });
    if (document.activeElement !== get("scroll")) get("scroll").value = charts.edge;
    document.body.dataset.drawn = ++drawn;
  }
  words.show(heard);
  requestAnimationFrame(draw);
}
const sized = new ResizeObserver(redraw);
for (const id of ["map", "world", "charts"]) sized.observe(get(id));
onTheme(() => {
  legend(get("legend-box"));
  redraw();
});
draw();
