// The robot's own screen, live as the twin draws it; a click on it is a touch.

const SCALE = 1.1; // CSS pixels of one of its own

export const screen = {
  id: "screen",
  title: "Screen",
  there: false,
  shown: () => screen.there,

  build(box, page) {
    box.innerHTML = `<p class="tools"><input type="image" alt="the robot's screen; a click touches it" data-id="glass"></p><small>the screen on the robot, as the twin draws it from its bytes; a click is a touch</small>`;
    this.glass = box.querySelector("input");
    this.glass.onclick = (event) => {
      event.preventDefault();
      if (!event.detail) return; // a key: it has no place
      const rect = this.glass.getBoundingClientRect();
      page.send({ do: "touch", x: Math.floor((event.clientX - rect.x) * this.wide / rect.width), y: Math.floor((event.clientY - rect.y) * this.high / rect.height) });
    };
  },

  hear: {
    connected() { screen.there = false; },
    screen({ png, wide, high }) {
      Object.assign(screen, { there: true, wide, high });
      Object.assign(screen.glass, { src: `data:image/png;base64,${png}`, width: wide * SCALE, height: high * SCALE });
    },
  },
};
