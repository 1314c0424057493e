// The panels behind the tabs. Those of the page itself stand in index.html; further ones are modules of their own, listed here.
//
// A panel module exports one object (docs/monitor.md, "Adding a panel"):
//     id, title      of its tab
//     shown(state)   whether this robot has it; asked anew when a robot says hello. Left out: always
//     build(box, page)   fills its element, once, when the page opens
//     hear           { type(message) } for messages of the robot or the monitor; `connected` comes first when another robot is opened
//     drawWorld(pen, view), drawRobot(pen, view)   over the map from above, round the robot; the pen is in mm, view.pixel is a CSS pixel in mm
//     press(point)   { x, y } mm in the map from above; true: it was meant for this panel. Asked only while its tab is open

import { arm } from "./arm.js";
import { gamepad } from "./gamepad.js";
import { goal } from "./goal.js";
import { screen } from "./screen.js";
import { twin } from "./twin.js";

const MODULES = [goal, arm, twin, gamepad, screen];

export class Panels {
  // page: what modules get, see main.js. state: the latest messages.
  constructor(page, state) {
    Object.assign(this, { page, state, modules: MODULES, panels: [] });
    this.tabs = document.getElementById("tabs");
    const box = document.getElementById("panels");
    for (const panel of box.querySelectorAll("[data-panel]")) this.add(panel, panel.dataset.panel, panel.dataset.title);
    for (const module of this.modules) {
      const panel = document.createElement("div");
      box.append(panel);
      module.panel = this.add(panel, module.id, module.title);
      module.build?.(panel, page);
    }
    this.tabs.onkeydown = (event) => this.walk(event);
    this.review();
    this.open("wheels");
  }

  add(panel, id, title) {
    const tab = document.createElement("button");
    Object.assign(tab, { type: "button", id: `tab-${id}`, textContent: title, onclick: () => this.open(id) });
    Object.assign(panel, { id: `panel-${id}`, tabIndex: -1 });
    for (const [name, value] of Object.entries({ role: "tab", "aria-controls": panel.id })) tab.setAttribute(name, value);
    for (const [name, value] of Object.entries({ role: "tabpanel", "aria-labelledby": tab.id })) panel.setAttribute(name, value);
    this.tabs.append(tab);
    this.panels.push({ id, tab, panel });
    return this.panels[this.panels.length - 1];
  }

  open(id) {
    this.chosen = id;
    for (const one of this.panels) {
      one.panel.hidden = one.id !== id;
      one.tab.setAttribute("aria-selected", one.id === id);
      one.tab.tabIndex = one.id === id ? 0 : -1;
    }
  }

  // Arrow keys go from tab to tab.
  walk(event) {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.code];
    if (!step) return;
    const there = this.panels.filter((one) => !one.tab.hidden);
    const at = there.findIndex((one) => one.id === this.chosen);
    const next = there[(at + step + there.length) % there.length];
    this.open(next.id);
    next.tab.focus();
  }

  // Whose robot this is shows which panels it has.
  review() {
    for (const { panel, shown } of this.modules) {
      panel.tab.hidden = shown ? !shown(this.state) : false;
      if (panel.tab.hidden && this.chosen === panel.id) this.open("wheels");
    }
  }

  hear(message) {
    for (const { hear } of this.modules) hear?.[message.type]?.(message);
    if (["connected", "hello", "screen", "map"].includes(message.type)) this.review();
  }

  draw(name, pen, view) {
    for (const module of this.modules) {
      if (module.panel.tab.hidden || !module[name]) continue;
      pen.save();
      module[name](pen, view);
      pen.restore();
    }
  }

  press(point) {
    return this.modules.some((module) => module.panel.id === this.chosen && !module.panel.tab.hidden && module.press?.(point));
  }
}
