// What the chip spends each turn of its loop on: of all the time, and the longest piece. Asked for only while somebody looks.

const NAMES = { lidar: "lidar, odometry, safety", planner: "deciding", drive: "wheels", link: "telling, and waiting", screen: "screen", start: "other" };
const BUDGET = 10; // ms a piece may take: a lidar frame comes every 9.5 ms

export class Turns {
  constructor(box) {
    this.box = box;
    this.rows = {};
  }

  show({ count, parts, sums, most }) {
    const all = sums.reduce((a, b) => a + b, 0) || 1;
    parts.forEach((part, k) => {
      if (!sums[k] && !this.rows[part]) return;
      const row = this.rows[part] || (this.rows[part] = this.build(part));
      row.bar.value = sums[k] / all;
      row.share.textContent = `${Math.round(100 * sums[k] / all)} %`;
      row.most.textContent = `${most[k].toFixed(1)} ms`;
      row.most.className = most[k] > BUDGET ? "bad" : "";
    });
    this.title.textContent = `${count} turns, ${(all / count).toFixed(1)} ms each`;
  }

  build(part) {
    if (!this.title) {
      this.title = document.createElement("p");
      this.title.className = "hint";
      this.box.append(this.title);
    }
    const row = document.createElement("p"), name = document.createElement("span"), bar = document.createElement("meter"), share = document.createElement("span"), most = document.createElement("span");
    row.className = "turn";
    name.textContent = NAMES[part] || part;
    bar.setAttribute("aria-label", `share of ${name.textContent}`);
    most.title = "the longest piece";
    row.append(name, bar, share, most);
    this.box.append(row);
    return { bar, share, most };
  }
}
