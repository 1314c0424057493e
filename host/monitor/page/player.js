// Recording, replaying with a time slider, and going to another robot.

const clock = (seconds) => `${Math.floor(seconds / 60)}:${(seconds % 60).toFixed(1).padStart(4, "0")}`;

export class Player {
  constructor(send) {
    const get = (id) => document.getElementById(id);
    Object.assign(this, { send, get, recordingPath: null, held: false });
    get("record").onclick = () => send({ do: this.recordingPath ? "end_recording" : "record" });
    get("again").onclick = () => send({ do: "again" });
    get("open").onsubmit = (event) => {
      event.preventDefault();
      if (get("where").value) send({ do: "open", address: get("where").value.trim() });
    };
    get("play").onclick = () => send({ do: "play", playing: !this.playing });
    get("rate").onchange = () => send({ do: "play", rate: Number(get("rate").value) });
    const slider = get("position");
    slider.onpointerdown = () => { this.held = true; };
    slider.onpointerup = () => { this.held = false; };
    slider.oninput = () => send({ do: "play", position: Number(slider.value) });
  }

  connected({ address, commands, recording }) {
    this.get("address").textContent = address;
    this.get("where").value = address;
    this.get("player").hidden = commands;
    for (const id of ["auto", "manual", "stop", "keep", "keep-restart", "restart", "record"]) this.get(id).disabled = !commands;
    this.recording(recording);
  }

  recording(path) {
    this.recordingPath = path;
    this.get("record").textContent = path ? "End recording" : "Record";
    this.get("record").classList.toggle("on", Boolean(path));
    this.get("recording").textContent = path ? `into ${path}` : "";
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
