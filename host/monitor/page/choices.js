// Buttons of which one is chosen, and buttons that are on or off. No tick boxes: the space bar stops the robot wherever the cursor is.

// options: [[value, title], ...] into a radio group. chosen(value) is called at a choice; returns a callable that shows another choice.
export function choices(box, options, value, chosen) {
  const show = (now) => {
    for (const button of box.children) button.setAttribute("aria-checked", button.dataset.value === String(now));
  };
  for (const [one, title] of options) {
    const button = document.createElement("button");
    Object.assign(button, { type: "button", textContent: title });
    button.dataset.value = one;
    button.setAttribute("role", "radio");
    button.onclick = () => {
      show(one);
      chosen(one);
    };
    box.append(button);
  }
  show(value);
  return show;
}

export const isOn = (button) => button.getAttribute("aria-pressed") === "true";

export function toggle(button, turned) {
  button.onclick = () => {
    button.setAttribute("aria-pressed", !isOn(button));
    turned(isOn(button));
  };
}
