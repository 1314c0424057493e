"""The picture of docs/screen.md: the robot's screen while it drives, and while something is set. `make animation` makes it again."""

from PIL import Image

from host.twin import Observer, image, run

TARGET = image.ROOT / "docs" / "screen.png"
GAP = 24  # pixels between the two
SET, NEXT, MORE = (200, 270), (40, 305), (120, 305)  # where its buttons are


class _Person(Observer):
    """Touches the screen, then looks at it. touches: [(s, (x, y))]."""

    def __init__(self, touches, look_s):
        self._touches, self._look_us = list(touches), look_s * 1e6
        self.seen = Image.new("RGB", (1, 1))
        self._looked = False

    def step(self, simulation):
        while self._touches and simulation.now >= self._touches[0][0] * 1e6:
            simulation.screen.touch(simulation.now, *self._touches.pop(0)[1])
        if not self._looked and simulation.now >= self._look_us:
            self._looked = True
            self.seen = simulation.screen.glass.picture(1)


def make(path=TARGET):
    """Drive twice for a few seconds and write the picture."""
    driving, setting = _Person((), 15.5), _Person(((5, SET), (5.4, NEXT), (5.8, MORE)), 7.5)
    for person, starts in ((driving, True), (setting, False)):
        run("Z", width=500, seed=1, limit_s=16 if starts else 8, watch=person, changes={"screen.kind": "usart-gpu", "drive.autostart": starts}, record=False)
    width, height = driving.seen.size
    out = Image.new("RGB", (2 * width + GAP, height), "#ffffff")
    out.paste(driving.seen, (0, 0))
    out.paste(setting.seen, (width + GAP, 0))
    out.quantize(64).save(path, optimize=True)


if __name__ == "__main__":
    make()
