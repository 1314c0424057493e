// Health in figures and words, and a short log.

const LINES = 60;

export class Health {
  constructor(list, log) {
    Object.assign(this, { list, log, fields: {} });
  }

  show(health, faults) {
    this.put("robot", health.fault ? faults?.[health.fault] || `fault ${health.fault}` : "all is well", health.fault);
    this.put("battery", health.battery === null ? "not measured" : `${health.battery.toFixed(2)} V`);
    this.put("lidar", `${health.lidar_speed.toFixed(2)} r/s, ${health.frames} frames, ${health.errors} bad`, !health.lidar_ok);
    this.put("chips", health.chips ? "answer" : "silent", !health.chips);
    this.put("worst loop", `${health.worst.toFixed(1)} ms`, health.worst > 100);
    this.put("heap free", `${(health.heap / 1000).toFixed(0)} kB`, health.heap < 1500);
    this.put("running for", `${Math.floor(health.uptime / 60)} min ${Math.floor(health.uptime % 60)} s`);
    this.put("link", `${health.dropped} dropped, ${health.refused} refused`);
  }

  put(name, text, bad = false) {
    if (!this.fields[name]) {
      const term = document.createElement("dt"), value = document.createElement("dd");
      term.textContent = name;
      this.list.append(term, value);
      this.fields[name] = value;
    }
    this.fields[name].textContent = text;
    this.fields[name].className = bad ? "bad" : "";
  }

  say(text) {
    const lines = this.log.textContent.split("\n").filter(Boolean);
    if (lines[lines.length - 1] === text) return;
    lines.push(text);
    this.log.textContent = lines.slice(-LINES).join("\n");
    this.log.scrollTop = this.log.scrollHeight;
  }
}
