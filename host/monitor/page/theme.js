// The colours of style.css, for what is drawn; they follow the system's choice of light or dark.

const NAMES = [
  "text", "faint", "line", "faint-line", "wall", "body", "edge", "well", "card", "chosen", "refused", "other", "green", "red", "blue", "yellow", "stop",
];

export const colours = {};
const watchers = [];

function read() {
  const style = getComputedStyle(document.documentElement);
  for (const name of NAMES) colours[name.replace("-l", "L")] = style.getPropertyValue(`--${name}`).trim();
  colours.windows = [colours.faint, colours.green, colours.red, colours.blue, colours.yellow]; // none, green, red, blue, yellow
  for (const changed of watchers) changed();
}

// A colour as #rrggbb, more or less transparent: share 0..1.
export function faded(colour, share) {
  return colour + Math.round(share * 255).toString(16).padStart(2, "0");
}

export function onTheme(changed) {
  watchers.push(changed);
}

read();
matchMedia("(prefers-color-scheme: light)").addEventListener("change", read);
