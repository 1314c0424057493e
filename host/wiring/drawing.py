"""The wiring as an SVG: the ESP32 in the middle, what it hears on its left, the chips it writes to on its right, the supplies below."""

from html import escape

from . import MOTORS_OF_A_MODULE

INK, GREY, PAPER, CARD, EDGE = "#2b2d33", "#666666", "#ffffff", "#fbfaf7", "#c9c5ba"
SIGNAL, BUS, SAFETY = "#1f6f8b", "#d1495b", "#9a6700"
RAILS = {"battery": "#b3261e", "6 V": "#c26a00", "5 V": "#8250df", "3.3 V": "#2f7d4f", "GND": "#2b2d33"}
ROW = 26  # from one pin to the next
LEFT, LEFT_WIDE = 30, 200
ESP, ESP_WIDE = 400, 170
CHIP, CHIP_WIDE = 730, 160
LOAD, LOAD_WIDE = 960, 250
WIDE = LOAD + LOAD_WIDE + 30
FONT = "font-family='DejaVu Sans, Verdana, sans-serif'"

# device: (title, what it stands on, rails of its supply)
DEVICES = {
    "lidar": ("lidar", "Delta-2B", ("5 V", "GND")),
    "lidar motor driver": ("lidar motor driver", "transistor, to M+ and M-", ("5 V", "GND")),
    "stop button": ("stop button", "", ("GND",)),
    "battery divider": ("battery divider", "two resistors", ("battery", "GND")),
    "screen": ("touch screen", "", ("5 V", "GND")),
}
SUPPLIES = (
    ("battery", "7.4 V LiPo, fuse, main switch", ("battery", "GND")),
    ("motor supply", "the battery itself, to the L298N modules", ("battery", "GND")),
    ("servo converter", "battery to 6 V, for all servos", ("6 V", "GND")),
    ("logic converter", "battery to 5 V: ESP32 board, lidar", ("5 V", "GND")),
    ("regulator on the ESP32 board", "3.3 V: PWM chips (VCC), pull-ups", ("3.3 V", "GND")),
)


class _Page:
    """Collects the elements of an SVG."""

    def __init__(self):
        self.parts = []

    def box(self, x, y, wide, high, fill=CARD, edge=EDGE):
        self.parts.append(f"<rect x='{x}' y='{y}' width='{wide}' height='{high}' rx='6' fill='{fill}' stroke='{edge}'/>")

    def line(self, colour, *places, width=1.6):
        points = " ".join(f"{x},{y}" for x, y in places)
        self.parts.append(f"<polyline points='{points}' fill='none' stroke='{colour}' stroke-width='{width}' stroke-linejoin='round'/>")

    def dot(self, colour, x, y):
        self.parts.append(f"<circle cx='{x}' cy='{y}' r='3' fill='{colour}'/>")

    def text(self, x, y, words, size=12, colour=INK, anchor="start", bold=False):
        weight = " font-weight='bold'" if bold else ""
        self.parts.append(f"<text x='{x}' y='{y}' font-size='{size}' fill='{colour}' text-anchor='{anchor}'{weight}>{escape(str(words))}</text>")

    def rails(self, x, y, names):
        """Small labels of supplies, the first one beginning at x."""
        for name in names:
            wide = 12 + 7 * len(name)
            self.parts.append(f"<rect x='{x}' y='{y - 9}' width='{wide}' height='15' rx='7' fill='{RAILS[name]}'/>")
            self.text(x + wide / 2, y + 2.5, name, 9.5, PAPER, "middle")
            x += wide + 4

    def svg(self, high):
        head = f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {WIDE} {high}' width='{WIDE}' height='{high}' {FONT}>"
        return "\n".join([head, f"<rect width='{WIDE}' height='{high}' fill='{PAPER}'/>", *self.parts, "</svg>"]) + "\n"


def draw(wired, title="robot.json"):
    """The SVG of a Wiring, a str."""
    page = _Page()
    page.text(LEFT, 34, f"Wiring: {wired.axles} axles, {2 * wired.axles} wheels", 17, bold=True)
    page.text(LEFT, 54, f"by {title}; the chips' inputs and all supplies share one GND", 11.5, GREY)
    top = 84
    left = _left(page, wired, top)
    right, bus = _right(page, wired, top)
    _esp32(page, left, bus, top, wired)
    low = max(left[-1][1] + 60 if left else top, right) + 30
    return page.svg(_supplies(page, low) + 24)


def _left(page, wired, y):
    """Draws what the ESP32 hears and a few that it drives; [(Wire, y of its line)]."""
    out = []
    devices = [name for name in DEVICES if any(wire.device == name for wire in wired.pins)]
    for name in devices:
        wires = [wire for wire in wired.pins if wire.device == name]
        title, what, rails = DEVICES[name]
        high = 44 + ROW * len(wires)
        page.box(LEFT, y, LEFT_WIDE, high)
        page.text(LEFT + 12, y + 19, title, 12.5, bold=True)
        page.text(LEFT + 12, y + 34, what or {"screen": wired.screen}.get(name, ""), 10.5, GREY)
        for k, wire in enumerate(wires):
            at = y + 46 + ROW * k
            page.text(LEFT + LEFT_WIDE - 10, at + 4, wire.terminal, 11, anchor="end")
            out.append((wire, at))
        page.rails(LEFT + 12, y + high - 14, rails)
        y += high + 22
    return out


def _right(page, wired, y):
    """Draws the three chips and what hangs on them; (lower end, {terminal: [y]})."""
    bus: dict[str, list] = {"SCL": [], "SDA": [], "OE": []}
    terminals = {wire.terminal for wire in wired.pins if wire.device == "PWM chips"}
    for name in ("servos", "left", "right"):
        rows = wired.servos if name == "servos" else wired.motors[name]
        high = max(_rows_high(name, rows), 128)
        page.box(CHIP, y, CHIP_WIDE, high)
        page.text(CHIP + CHIP_WIDE / 2, y + 20, f"PCA9685  0x{wired.chips[name]:02x}", 12.5, anchor="middle", bold=True)
        page.text(CHIP + CHIP_WIDE / 2, y + 36, "steering servos" if name == "servos" else f"{name} motors", 10.5, GREY, "middle")
        for k, terminal in enumerate(bus):
            if terminal in terminals:
                at = y + 54 + 22 * k
                page.text(CHIP + 10, at + 4, terminal, 11)
                bus[terminal].append(at)
        page.rails(CHIP + 10, y + high - 14, ("3.3 V", "GND"))
        (_servos if name == "servos" else _motors)(page, y, rows, name)
        y += high + 22
    return y, {terminal: places for terminal, places in bus.items() if places}


def _rows_high(name, rows):
    return 46 + 18 * -(-len(rows) // 2) if name == "servos" else 22 + 50 * -(-len(rows) // MOTORS_OF_A_MODULE)


def _servos(page, y, rows, _):
    half = -(-len(rows) // 2)
    page.box(LOAD, y, LOAD_WIDE, 46 + 18 * half)
    for k, (output, wheel) in enumerate(rows):
        column, row = divmod(k, half)
        x, at = LOAD + 12 + column * LOAD_WIDE / 2, y + 26 + 18 * row
        page.text(x + 16, at, output, 11, SIGNAL, "end", bold=True)
        page.text(x + 24, at, wheel, 11)
    page.rails(LOAD + LOAD_WIDE - 84, y + 24 + 18 * half, ("6 V", "GND"))
    page.line(SIGNAL, (CHIP + CHIP_WIDE, y + 40), (LOAD, y + 40), width=4)
    page.text(CHIP + CHIP_WIDE + 6, y + 33, "outputs", 9.5, GREY)


def _motors(page, y, rows, side):
    for module in range(-(-len(rows) // MOTORS_OF_A_MODULE)):
        pair = rows[module * MOTORS_OF_A_MODULE :][:MOTORS_OF_A_MODULE]
        top = y + 50 * module
        page.box(LOAD, top, LOAD_WIDE, 44)
        page.text(LOAD + 12, top + 18, f"L298N {side} {module + 1}", 11.5, bold=True)
        page.rails(LOAD + 12, top + 33, ("battery", "GND"))
        for k, (one, two, wheel) in enumerate(pair):
            page.text(LOAD + 158, top + 18 + 18 * k, f"{one}, {two}", 11, SIGNAL, "end", bold=True)
            page.text(LOAD + 166, top + 18 + 18 * k, wheel, 11)
        page.line(SIGNAL, (CHIP + CHIP_WIDE, top + 22), (LOAD, top + 22), width=4 if len(pair) > 1 else 2.5)
    page.text(CHIP + CHIP_WIDE + 6, y + 15, "IN1, IN2", 9.5, GREY)


def _esp32(page, left, bus, top, wired):
    pins = {wire.terminal: wire for wire in wired.pins if wire.device == "PWM chips"}
    bottom = max([at for _, at in left] + [top + 120])
    page.box(ESP, top, ESP_WIDE, bottom - top + 60, "#eef3f5", INK)
    page.text(ESP + ESP_WIDE / 2, top + 22, "ESP32", 15, anchor="middle", bold=True)
    page.text(ESP + ESP_WIDE / 2, top + 38, "WROOM-32 board", 10.5, GREY, "middle")
    page.rails(ESP + ESP_WIDE / 2 - 36, bottom + 40, ("5 V", "GND"))
    for wire, at in left:
        colour = SAFETY if wire.device == "stop button" else SIGNAL
        page.line(colour, (LEFT + LEFT_WIDE, at), (ESP, at))
        page.text(ESP + 10, at + 4, wire.gpio, 12, bold=True)
        page.text((LEFT + LEFT_WIDE + ESP) / 2, at - 5, wire.key, 9.5, GREY, "middle")
    for k, (terminal, places) in enumerate(bus.items()):
        colour = SAFETY if terminal == "OE" else BUS if terminal == "SDA" else SIGNAL
        column, at = ESP + ESP_WIDE + 62 + 26 * k, places[0]
        page.line(colour, (ESP + ESP_WIDE, at), (CHIP, at))
        page.line(colour, (column, at), (column, places[-1]))
        for place in places[1:]:
            page.line(colour, (column, place), (CHIP, place))
        for place in places[:-1]:
            page.dot(colour, column, place)
        page.text(ESP + ESP_WIDE - 10, at + 4, pins[terminal].gpio, 12, anchor="end", bold=True)
        page.text(ESP + ESP_WIDE + 8, at - 4, terminal, 9.5, GREY)
    if bus:
        at = max(places[-1] for places in bus.values()) + 22
        for k, words in enumerate(("SCL, SDA: 2.2 to 4.7 kOhm each to 3.3 V", "OE: 10 kOhm to 3.3 V")):
            page.text(CHIP - 14, at + 15 * k, words, 9.5, GREY, "end")


def _supplies(page, y):
    page.text(LEFT, y + 4, "Supplies", 13.5, bold=True)
    wide = (WIDE - 2 * LEFT - 4 * 16) / 5
    for k, (name, what, rails) in enumerate(SUPPLIES):
        x = LEFT + k * (wide + 16)
        page.box(x, y + 18, wide, 78)
        page.text(x + 12, y + 38, name, 11.5, bold=True)
        page.text(x + 12, y + 55, what, 9.5 if len(what) < 38 else 9, GREY)
        page.rails(x + 12, y + 80, rails)
    return y + 96
