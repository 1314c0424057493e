"""Setting by touch: one thing at a time, with previous and next, less and more, keep and back. Loaded by a touch of "set", let go after; the robot stands meanwhile.

What is set counts at once but for the mode, the margin and the network: those count from the next start, and only if kept.
"""

from array import array

from micropython import const

from core.unload import forget
from link.screen_kernels import emit
from params.settings import Settings

forget("params.settings")  # what has been taken from it stays

_LIVE = ("drive.cruise", "avoid.margin", "windows.red", "windows.blue")
_LABELS = ("    <         -       KEEP", "    >         +       BACK")
_OWN_NAME = "gapseeker"
_PALETTE = const(16)  # in the work of a Screen


def touch(screen, button, robot, link):
    """A button was touched: 1 and 4 go to what comes before and after, 2 and 5 make it less and more, 3 keeps, 6 goes back. screen: its page is 0 to begin with."""
    wheels = 2 * link.config.axles
    count = len(_LIVE) + wheels + 3  # the mode before, the network and the restart behind
    note = ""
    settings = Settings(link.config, robot.drive, link.changed)
    try:
        if not screen.page:
            screen.page = 1
            _clear(screen)
        elif button == 6:
            screen.leave()
            return
        elif button == 3:
            settings.keep()
            note = "kept"
        elif button == 1 or button == 4:
            screen.page = (screen.page - 1 + (1 if button == 4 else -1)) % count + 1
        else:
            note = _change(settings, screen.page - 1, wheels, 1 if button == 5 else -1, link)
    except ValueError as error:
        note = str(error).split(": ")[-1]
    key, value = _look(screen.page - 1, wheels, link)
    _line(screen, 200, "%d/%d %s" % (screen.page, count, key), 5)
    _line(screen, 218, value, 6)
    _line(screen, 236, note, 4)


def _look(number, wheels, link):
    """(what it is called, its value as text)."""
    config = link.config
    if number == 0:
        return "mode", _now("mode", link)
    number -= 1
    if number < len(_LIVE):
        key = _LIVE[number]
        return key, str(getattr(config, key.replace(".", "_")))
    number -= len(_LIVE)
    if number < wheels:
        trim = config.servos_trims[number]
        side = "right" if number & 1 else "left"
        return "trim, axle %d %s" % (number // 2 + 1, side), "%s%d.%d deg" % ("-" if trim < 0 else "", abs(trim) // 10, abs(trim) % 10)
    if number == wheels:
        name = _now("ssid", link)
        return "network", "none" if not name else ("own: " if _now("access_point", link) == "true" else "joins ") + name
    return "restart", "touch +"


def _change(settings, number, wheels, step, link):
    """Make it a step more or less; returns what there is to say."""
    config = link.config
    changed = link.changed
    if number == 0:
        changed["mode"] = "AWS" if _now("mode", link) == "NAWS" else "NAWS"
    elif number <= len(_LIVE):
        key = _LIVE[number - 1]
        if settings.tune(key, getattr(config, key.replace(".", "_")) + step):
            return "keep it, then restart"
        return ""
    elif number <= len(_LIVE) + wheels:
        wheel = number - 1 - len(_LIVE)
        settings.tune("servos.trims.%d" % wheel, (config.servos_trims[wheel] + 5 * step) / 10)
        return ""
    elif number == len(_LIVE) + wheels + 1:
        name = _now("ssid", link)
        if step > 0 and not name:
            changed["wifi.ssid"] = _OWN_NAME
            changed["wifi.access_point"] = True
        elif step > 0:
            changed["wifi.access_point"] = _now("access_point", link) != "true"
        else:
            changed["wifi.ssid"] = ""
    else:
        link.restarting = step > 0
        return "restarts" if step > 0 else ""
    return "keep it, then restart"


def _now(name, link):
    """What a setting that counts from the next start will be, or is: from what was changed, else from robot.json; "" where it is not in there."""
    for key, value in link.changed.items():
        if key == name or key == "wifi." + name:
            return value if type(value) is str else "true" if value else "false"
    with open("robot.json", "rb") as file:
        text = file.read()
    at = text.find(b'"%s"' % name.encode())
    if at < 0:
        return ""
    value = text[at + len(name) + 2 : at + len(name) + 80].split(b":", 1)[1].strip()
    return value[1:].split(b'"')[0].decode() if value[:1] == b'"' else value.split(b",")[0].split(b"}")[0].strip().decode()


def _clear(screen):
    """The buttons of setting."""
    _box(screen, 0, 256, 240, 64, 0)
    for k in range(2):
        _line(screen, 263 + 32 * k, _LABELS[k], 6)
    for x, y, wide, high in ((0, 256, 240, 1), (0, 288, 240, 1), (80, 256, 1, 64), (160, 256, 1, 64)):
        _box(screen, x, y, wide, high, 5)


def _box(screen, x, y, wide, high, colour):
    _add(screen, 0, b"", (x, y, x + wide - 1, y + high - 1, wide, high, screen.work[_PALETTE + colour]))


def _line(screen, y, text, colour):
    _add(screen, 1, text[:29].encode(), (4, y, 0, y + 17, 0, 0, screen.work[_PALETTE + colour]))


def _add(screen, number, text, values):
    """Queue a box or a line: texts 0 and 1 of a Screen, a byte 8 in which stands for the text."""
    ends = screen.ends
    form = screen.texts[ends[number - 1] if number else 0 : ends[number]] + text
    data = bytearray(160)
    at = emit(data, 0, form, array("H", (len(form) - len(text), len(form))), 0, array("i", values + (0,) * 8 + (1,)))
    screen.queue.append((data, array("H", (at,)), 0))
