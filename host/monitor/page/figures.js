// A line of figures that does not move as their digits change: each has a place of its own, as wide as it will ever need.

export class Figures {
  // fields: [name, unit, digits]; "" as the name of one that says itself.
  constructor(element, fields) {
    this.values = fields.map(([name, unit, digits]) => {
      const box = document.createElement("span"), value = document.createElement("b");
      value.style.minWidth = `${digits}ch`;
      box.append(name ? `${name} ` : "", value, unit);
      element.append(box, " ");
      return value;
    });
  }

  show(...values) {
    values.forEach((value, i) => {
      const text = value === null || value === undefined ? "–" : String(value);
      if (this.values[i].textContent !== text) this.values[i].textContent = text;
    });
  }
}
