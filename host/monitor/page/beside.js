// What is shown beside the run that is open: another recording, or the same one driven again with other settings.

export class Beside {
  constructor(send, { charts, world }) {
    const get = (id) => document.getElementById(id);
    Object.assign(this, { send, get, charts, world });
    get("again-with").onsubmit = (event) => {
      event.preventDefault();
      this.runAgain(get("changes").value);
    };
    get("beside-none").onclick = () => send({ do: "compare", path: "" });
  }

  clear() {
    this.run = this.other = null;
    this.world.run = this.world.other = null;
    this.show();
  }

  // The whole of the recording that is open.
  whole(run) {
    this.run = run;
    this.charts.run(run.decisions);
    this.world.run = { ...run, marks: [] };
    this.show();
  }

  also(other) {
    this.other = other.decisions ? other : null;
    this.show();
  }

  show() {
    const { run, other, get } = this;
    get("again-with").hidden = !run;
    get("beside").hidden = !other;
    this.charts.other = null;
    this.world.other = null;
    this.say("");
    if (!other) return;
    get("beside-name").textContent = `${other.name}${other.text ? `: ${other.text}` : ""}`;
    // Both begin with their first decision: how long each had been recorded before does not matter.
    const late = other.track.length && other.decisions.length ? (run?.decisions[0]?.at ?? 0) - other.decisions[0].at : 0;
    const moved = (rows) => rows.map((row) => ({ ...row, at: row.at + late }));
    this.charts.other = moved(other.decisions);
    const track = run?.track.length && other.frame !== run.frame ? laid(other.track, run.track[0]) : other.track;
    this.world.other = { ...other, track: moved(track) };
  }

  // The other robot's place at a time of the recording that is open; and the marks where this one stopped.
  at(time, marks) {
    const { other } = this.world;
    if (other) other.place = placeAt(other.track, time);
    if (this.world.run) this.world.run.marks = marks.map((mark) => ({ ...mark, ...placeAt(this.world.run.track, mark.at) }));
  }

  runAgain(text) {
    const set = {};
    for (const part of text.split(",").map((one) => one.trim()).filter(Boolean)) {
      const [key, value] = part.split("=").map((one) => one?.trim());
      if (!value) return this.say(`${part}: write section.key=value, as in avoid.margin=20`, true);
      set[key] = value !== "" && Number.isFinite(Number(value)) ? Number(value) : value;
    }
    this.say("the firmware drives it again ...");
    return this.send({ do: "run_again", set });
  }

  say(text, bad = false) {
    const note = this.get("again-note");
    note.textContent = text;
    note.className = bad ? "trouble" : "hint";
    this.get("changes").setAttribute("aria-invalid", bad);
  }
}

export function placeAt(track, time) {
  let found = track[0];
  for (const place of track) {
    if (place.at > time) break;
    found = place;
  }
  return found && { x: found.x, y: found.y, heading: found.heading };
}

// A track turned and moved so that it begins at a place.
function laid(track, start) {
  if (!track.length) return track;
  const first = track[0], turn = (start.heading - first.heading) * Math.PI / 180, s = Math.sin(turn), c = Math.cos(turn);
  return track.map(({ at, x, y, heading }) => {
    const dx = x - first.x, dy = y - first.y;
    return { at, x: start.x + dx * c + dy * s, y: start.y - dx * s + dy * c, heading: heading + start.heading - first.heading };
  });
}
