"""What a page may ask: each command's name, and whose part it is. A new panel's commands get a row here, and nothing else of the server changes.

TO_ROBOT    handed on over the link: (link, what). Refused where the link takes none, as a recording does.
HERE        answered by this computer: (station, what) -> message for the asker alone, or None.

what: the page's JSON object. KeyError, TypeError and ValueError become a message `refused` to the page that asked.
"""

from collections.abc import Callable

from host.link.base import Link


def _drive(link: Link, what: dict) -> None:
    link.drive(what["what"], float(what.get("af", 0)), float(what.get("ar", 0)), float(what.get("v", 90)))


TO_ROBOT: dict[str, Callable[[Link, dict], None]] = {
    "drive": _drive,
    "tune": lambda link, what: link.tune(str(what["key"]), what["value"]),
    "keep": lambda link, what: link.keep(),
    "list": lambda link, what: link.request_parameters(),
    "watch": lambda link, what: link.watch(bool(what.get("scan")), bool(what.get("candidates"))),
    "restart": lambda link, what: link.restart(),
    "point": lambda link, what: link.point(int(what["wheel"]), float(what["angle"])),
}

HERE: dict[str, Callable] = {}
