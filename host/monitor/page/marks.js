// How the four windows look: each in its colour, and each in a shape of its own, for those who do not tell the colours apart.

import { colours, faded } from "./theme.js";

export const WINDOWS = ["seen, in no window", "touching", "emergency: stops", "caution: turns away", "planning: drives by"];
const SIZES = [3, 9, 9, 7, 5]; // CSS pixels

// pen at x, y; size of a CSS pixel; age 0 new .. 1 old.
export function mark(pen, x, y, pixel, window, age = 0) {
  const size = SIZES[window] * pixel, h = size / 2;
  const colour = colours.windows[window];
  pen.fillStyle = window || age ? faded(colour, 1 - 0.75 * age) : faded(colour, 0.6);
  if (window === 4 || window === 0) {
    pen.fillRect(x - h, y - h, size, size);
    return;
  }
  pen.beginPath();
  if (window === 1) {
    pen.arc(x, y, h, 0, 2 * Math.PI);
  } else if (window === 2) {
    pen.moveTo(x, y + h);
    pen.lineTo(x + h, y - h);
    pen.lineTo(x - h, y - h);
  } else {
    pen.moveTo(x, y + h);
    pen.lineTo(x + h, y);
    pen.lineTo(x, y - h);
    pen.lineTo(x - h, y);
  }
  pen.fill();
}

const SYMBOLS = {
  window: (number) => (pen) => mark(pen, 11, 8, 1.3, number),
  way: (pen) => {
    pen.fillStyle = faded(colours.chosen, 0.25);
    pen.fillRect(2, 3, 18, 10);
    pen.strokeStyle = colours.chosen;
    pen.strokeRect(2, 3, 18, 10);
  },
  refused: (pen) => cross(pen, 11, 8, colours.refused, 4, 1),
  block: (pen) => {
    cross(pen, 11, 8, colours.red, 3, 1);
    pen.beginPath();
    pen.arc(11, 8, 6.5, 0, 2 * Math.PI);
    pen.stroke();
  },
  wheel: (pen) => {
    pen.fillStyle = colours.edge;
    pen.fillRect(8, 2, 6, 12);
  },
};

const LEGEND = [
  ...[4, 3, 2, 1, 0].map((number) => [SYMBOLS.window(number), `${["", "green", "red", "blue", "yellow"][number] || "grey"}: ${WINDOWS[number]}`]),
  [SYMBOLS.way, "what the body will sweep, and its corners' tracks"],
  [SYMBOLS.refused, "a steering refused: its track, and the point that ends it"],
  [SYMBOLS.block, "the point that decides now"],
  [SYMBOLS.wheel, "wheels; those that roll show an arrow"],
];

// The legend into its box, drawn anew for light and dark.
export function legend(box) {
  box.replaceChildren(...LEGEND.map(([symbol, text]) => {
    const row = document.createElement("div"), canvas = document.createElement("canvas");
    const ratio = devicePixelRatio || 1;
    Object.assign(canvas, { width: 22 * ratio, height: 16 * ratio, style: "width: 22px; height: 16px; background: none" });
    canvas.setAttribute("aria-hidden", "true");
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    pen.lineWidth = 1.5;
    symbol(pen);
    row.append(canvas, text);
    return row;
  }));
}

export function cross(pen, x, y, colour, size, pixel) {
  const d = size * pixel;
  pen.strokeStyle = colour;
  pen.lineWidth = 2 * pixel;
  pen.beginPath();
  pen.moveTo(x - d, y - d);
  pen.lineTo(x + d, y + d);
  pen.moveTo(x - d, y + d);
  pen.lineTo(x + d, y - d);
  pen.stroke();
}
