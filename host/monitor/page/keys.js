// The keyboard: the space bar stops, wherever the focus is; arrows drive unless what has the focus needs them itself.

const ARROWS = "input, select, [role=tab], [role=img]";
const WRITING = "input:not([type=range]), select, textarea";

// act: { stop, auto, manual }; live(): whether there is a robot to command.
export function listen(hand, act, live) {
  addEventListener("keydown", (event) => {
    const { target } = event;
    if (event.code === "Space") {
      event.preventDefault();
      if (!event.repeat) act.stop();
      return;
    }
    if (target.matches?.(WRITING) || event.ctrlKey || event.metaKey || event.altKey || !live()) return;
    if (event.code.startsWith("Arrow") && target.matches?.(ARROWS)) return;
    if (hand.key(event.code, true)) event.preventDefault();
    else if (event.code === "KeyA") act.auto();
    else if (event.code === "KeyM") act.manual();
    else if (/^Digit[1-5]$/.test(event.code)) hand.choose(Number(event.code.slice(5)) - 1);
  }, true);
  addEventListener("keyup", (event) => {
    if (event.code === "Space") event.preventDefault();
    hand.key(event.code, false);
  }, true);
}
