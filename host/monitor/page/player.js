// Recording, replaying with a time slider, and going to another robot.

import { isOn, toggle } from "./choices.js";

const clock = (seconds) => `${Math.floor(seconds / 60)}:${(seconds % 60).toFixed(1).padStart(4, "0")}`;

export class Player {
  constructor(send) {
    const get = (id) => document.getElementById(id);
    Object.assign(this, { send, get, recordingPath: null, held: false });
    get("record").onclick = () => {
      // The robot tells raw scans to whoever asks, and they are recorded with the rest; the map shows them then.
      if (!this.recordingPath && isOn(get("with-scans")) && !isOn(get("scan"))) get("scan").click();
      send({ do: this.recordingPath ? "end_recording" : "record" });
    };
    toggle(get("with-scans"), () => {});
    get("again").onclick = () => send({ do: "again" });
    get("open").onsubmit = (event) => {
      event.preventDefault();
      this.open(get("where").value.trim());
    };
    get("where").oninput = () => this.refused("");
    get("saved").onclick = (event) => {
      event.preventDefault();
      this.open(`file:${get("saved").textContent}`);
    };
    get("play").onclick = () => send({ do: "play", playing: !this.playing });
    get("rate").onchange = () => send({ do: "play", rate: Number(get("rate").value) });
    const slider = get("position");
    slider.onpointerdown = () => { this.held = true; };
    slider.onpointerup = () => { this.held = false; };
    slider.oninput = () => send({ do: "play", position: Number(slider.value) });
  }

  // Go to a time of the recording that is open; there is none of a robot.
  seek(at) {
    if (!this.get("player").hidden) this.send({ do: "play", position: at });
  }

  open(address) {
    this.refused(address ? "" : "write where the robot is: twin:z?width=550, serial:/dev/ttyUSB0, udp:robot.local, file:out/drive.rec");
    if (address) this.send({ do: "open", address });
  }

  // The reason stands where the address was written; what is shown goes on belonging to the robot that is open.
  refused(text) {
    this.get("open-trouble").textContent = text;
    this.get("open-trouble").hidden = !text;
    this.get("where").setAttribute("aria-invalid", Boolean(text));
  }

  connected({ address, commands, recording }) {
    this.get("address").textContent = address;
    this.get("where").value = address;
    this.get("player").hidden = commands;
    for (const id of ["auto", "manual", "stop", "keep", "keep-restart", "restart", "record"]) this.get(id).disabled = !commands;
    this.refused("");
    this.recording(recording);
  }

  recording(path, saved) {
    this.recordingPath = path;
    this.get("record").textContent = path ? "End recording" : "Record";
    this.get("record").classList.toggle("on", Boolean(path));
    this.get("recording").textContent = path ? `into ${path}` : saved ? "saved:" : "";
    if (path || saved) {
      this.get("saved").textContent = saved || "";
      this.get("saved").hidden = !saved;
    }
  }

  playback({ position, length, playing }) {
    this.playing = playing;
    this.get("play").textContent = playing ? "Pause" : "Play";
    const slider = this.get("position");
    slider.max = length;
    if (!this.held) slider.value = position;
    this.get("clock").textContent = `${clock(position)} of ${clock(length)}`;
  }
}
