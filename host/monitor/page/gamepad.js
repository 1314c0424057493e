// The gamepads at hand: what their sticks and buttons mean, seen moving, and learned anew.

import { USES } from "./pads.js";

const ASK = { steer: "move it to the right", drive: "move it ahead" };

export const gamepad = {
  id: "gamepad",
  title: "Gamepad",

  build(box, page) {
    box.innerHTML = `<p class="hint">None so far: press a button on it, so that the browser tells of it.</p><div></div>`;
    Object.assign(this, { pads: page.pads, hint: box.firstChild, list: box.lastChild, shown: undefined, cards: [] });
    setInterval(() => !box.hidden && this.look(), 100);
  },

  look() {
    const there = [...this.pads.known.values()].filter(({ name }) => name !== null);
    const names = there.map(({ name }) => name).join("\n");
    if (names !== this.names) {
      this.names = names;
      this.hint.hidden = there.length > 0;
      this.cards = there.map(({ name }) => this.card(name));
      this.list.replaceChildren(...this.cards.map(({ box }) => box));
    }
    there.forEach((pad, k) => this.cards[k].show(pad));
  },

  card(name) {
    const box = document.createElement("div"), title = document.createElement("h3"), usual = document.createElement("button");
    box.className = "pad";
    title.textContent = name || "a pad without a name";
    Object.assign(usual, { type: "button", textContent: "As usual", title: "forget what was learned for this kind of pad" });
    const rows = Object.entries(USES).map(([use, text]) => this.row(name, use, text));
    usual.onclick = () => {
      this.pads.forget(name);
      for (const row of rows) row.tell();
    };
    box.append(title, ...rows.map((row) => row.box), usual);
    return { box, show: (pad) => rows.forEach((row) => row.show(pad)) };
  },

  row(name, use, text) {
    const box = document.createElement("p"), what = document.createElement("span"), now = document.createElement("meter"), learn = document.createElement("button");
    const stick = use in ASK;
    box.className = "use";
    Object.assign(learn, { type: "button", textContent: "Learn" });
    learn.setAttribute("aria-label", `learn ${text}`);
    Object.assign(now, { min: stick ? -1 : 0, max: 1, value: 0 });
    now.setAttribute("aria-label", `${text} now`);
    const tell = () => {
      const map = this.pads.mapping(name)[use];
      what.textContent = `${text}: ${stick ? `axis ${map.axis}${map.sign < 0 ? ", reversed" : ""}` : `button ${map.join(" or ")}`}`;
      learn.textContent = "Learn";
    };
    learn.onclick = () => {
      learn.textContent = ASK[use] || "press it";
      this.pads.learn(name, use, tell);
    };
    box.append(what, now, learn);
    tell();
    const show = ({ moved = [], pressed = [] }) => {
      const map = this.pads.mapping(name)[use];
      now.value = stick ? (moved[map.axis] || 0) * map.sign : Number(map.some((k) => pressed[k]));
    };
    return { box, tell, show };
  },
};
