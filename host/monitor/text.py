"""The monitor in a terminal: a small map of characters, figures, the reason in words; keys to drive. For ssh."""

import os
import select
import shutil
import sys
import textwrap
import time
from contextlib import contextmanager

from .station import Station

HELP = "space stop  a auto  arrows drive by hand  1-5 mode  r record  q quit"
LETTERS = " GRBY"  # window of a point
WINDOWS = ("", "green", "red", "blue", "yellow")
MODES = {
    "1": lambda x, y: (60 * x, -60 * x, y), "2": lambda x, y: (0, -60 * x, y), "3": lambda x, y: (60 * x, 0, y),
    "4": lambda x, y: (90, -90, x), "5": lambda x, y: (90 * x, 90 * x, abs(x)) if x else (0, 0, y),
}  # fmt: skip
ARROWS = {"\x1b[A": (0, 1), "\x1b[B": (0, -1), "\x1b[C": (1, 0), "\x1b[D": (-1, 0)}
SPEED = 15  # of V, by hand
MM = 40, 80  # of a character: across, along


def run(station: Station) -> int:
    """Show the robot until `q` or Ctrl-C."""
    latest: dict = {}
    said: list[str] = []

    def hear(message):
        latest[message["type"]] = message
        if message["type"] in ("text", "log", "event", "ended") or message["type"] == "reply" and message["status"] != "ok":
            said.append(message.get("text") or message.get("status"))
            del said[:-5]

    station.listen(hear)
    interactive = sys.stdin.isatty() and sys.stdout.isatty()
    mode = "1"
    try:
        with _keys(interactive) as keys:
            while True:
                if interactive:
                    print("\x1b[H" + "\x1b[K\n".join(picture(latest, said, station.recording)) + "\x1b[J", end="", flush=True)
                else:
                    print(line(latest), flush=True)
                for key in keys(0.1 if interactive else 1.0):
                    if key == "q":
                        return 0
                    mode = key if key in MODES else mode
                    try:
                        obey(station, key, mode)
                    except ValueError as error:
                        said.append(str(error))
                if "ended" in latest and not interactive:
                    print(latest["ended"]["text"])
                    return 0
    except KeyboardInterrupt:
        return 0
    finally:
        station.listeners.remove(hear)


def obey(station: Station, key: str, mode: str) -> None:
    if key == " ":
        station.command({"do": "drive", "what": "stop"})
    elif key == "a":
        station.command({"do": "drive", "what": "auto"})
    elif key == "r":
        station.command({"do": "end_recording" if station.recording else "record"})
    elif key in ARROWS:
        # Once a key press: the terminal repeats a key that is held, and a lost terminal repeats nothing.
        af, ar, speed = MODES[mode](*ARROWS[key])
        station.command({"do": "drive", "what": "manual", "af": af, "ar": ar, "v": 90 + SPEED * speed})


def figures(latest: dict) -> list[str]:
    """The decision and the health, a line each."""
    decision, health = latest.get("decision"), latest.get("health")
    lines = []
    if decision:
        steering = f"AF {decision['af']:5.1f}  AR {decision['ar']:5.1f}  V {decision['v']:3}"
        lines.append(f"{decision['time']:8.2f} s  {decision['state']:7}  {steering}  free {decision['free']:4} mm")
    if health:
        battery = "battery not measured" if health["battery"] is None else f"battery {health['battery']:.1f} V"
        lines.append(f"lidar {health['lidar_speed']:.1f} r/s{'' if health['lidar_ok'] else ' SILENT'}  {battery}")
    return lines


def line(latest: dict) -> str:
    """All that matters in one line, for a log."""
    return "  ".join([*figures(latest), reason(latest)]).strip() or "waiting for the robot"


def reason(latest: dict) -> str:
    """Why it does what it does, in words."""
    names, health, decision = latest.get("names", {}), latest.get("health"), latest.get("decision")
    if health and health["fault"]:
        faults = names.get("faults", [])
        return faults[health["fault"]] if health["fault"] < len(faults) else f"fault {health['fault']}"
    if decision is None:
        return ""
    reasons = names.get("reasons", [])
    text = reasons[decision["why"]] if decision["why"] < len(reasons) else f"reason {decision['why']}"
    if decision["state"] != "auto":
        return text
    window = WINDOWS[decision["window"]] if decision["window"] < len(WINDOWS) else ""
    return f"{text} ({window}, zone {decision['zone']})" if window and decision["zone"] is not None else text


def picture(latest: dict, said: list[str], recording: str | None = None) -> list[str]:
    """The screen as lines."""
    columns, rows = shutil.get_terminal_size((80, 30))
    out = [*figures(latest), reason(latest) or "waiting for the robot"]
    wheels = latest.get("wheels")
    if wheels:
        out.append(" ".join(f"{angle:5.0f}" for angle in wheels["angles"]) + "  deg")
        out.append(" ".join(f"{speed:5.0f}" for speed in wheels["speeds"]) + "  mm/s")
    said = [row for text in said for row in textwrap.wrap(text, columns - 1)][-6:]
    out += chart(latest, columns - 1, max(rows - len(out) - len(said) - 3, 5))
    out += said
    out.append((f"recording {recording}   " if recording else "") + HELP)
    return [row[: columns - 1] for row in out]


def chart(latest: dict, columns: int, rows: int) -> list[str]:
    """The points round the robot, head up, in characters."""
    field = [[" "] * columns for _ in range(rows)]

    def put(x, y, letter):
        column, row = columns // 2 + round(x / MM[0]), rows // 2 - round(y / MM[1])
        if 0 <= column < columns and 0 <= row < rows:
            field[row][column] = letter

    points = latest.get("points")
    if points:
        for x, y, window in zip(points["x"], points["y"], points["window"]):
            put(x, y, LETTERS[window] if window else ".")
    body = latest.get("hello", {})
    half_width, half_length = body.get("width", 250) / 2, body.get("length", 600) / 2
    across = [i * MM[0] for i in range(-int(half_width // MM[0]), int(half_width // MM[0]) + 1)]
    along = [i * MM[1] for i in range(-int(half_length // MM[1]), int(half_length // MM[1]) + 1)]
    for x in across:
        put(x, along[0], "-")
        put(x, along[-1], "-")
    for y in along:
        put(across[0], y, "|")
        put(across[-1], y, "|")
    put(0, along[-1], "^")
    block = (latest.get("decision") or {}).get("block")
    if block:
        put(block[0], block[1], "X")
    return ["".join(row).rstrip() for row in field]


@contextmanager
def _keys(interactive: bool):
    """Gives a callable seconds -> keys pressed in that time; the terminal is as before afterwards."""
    if not interactive:

        def wait(seconds):
            time.sleep(seconds)
            return []

        yield wait
        return
    import termios
    import tty

    descriptor = sys.stdin.fileno()
    before = termios.tcgetattr(descriptor)
    tty.setcbreak(descriptor)
    print("\x1b[?1049h\x1b[?25l", end="")

    def read(seconds):
        if not select.select([descriptor], [], [], seconds)[0]:
            return []
        text = os.read(descriptor, 64).decode(errors="replace")
        found = []
        while text:
            size = 3 if text.startswith("\x1b[") else 1
            found.append(text[:size])
            text = text[size:]
        return found

    try:
        yield read
    finally:
        print("\x1b[?25h\x1b[?1049l", end="", flush=True)
        termios.tcsetattr(descriptor, termios.TCSADRAIN, before)
