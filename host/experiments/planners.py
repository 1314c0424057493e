"""The firmware with its own planner, and with each of those it is compared with: copies in which lib/avoid.py is another."""

import hashlib
import os
import shutil
import tempfile
from pathlib import Path

from host.twin import image

from . import plan

BUILD = image.ROOT / "build" / "experiments"
BASELINES = Path(__file__).resolve().parent / "baselines"
_PAPER = image.ROOT / "host" / "bench" / "baselines" / "paper.py"
_TWIN = image.BOARD.parent
# The disc round the body, and the one as wide as it; each looks as far ahead as serves it best.
_DISCS = {
    plan.DISC_ROUND: ("sqrt(config.robot_length ** 2 + config.robot_width ** 2) / 2", "radius(config) + 225"),
    plan.DISC_NARROW: ("config.robot_width / 2", "LOOK_AHEAD + config.robot_length // 2"),
}
_DISC = '''"""The disc that the body is taken for: its radius, and how far it looks, mm."""

from math import sqrt

from scanning import LOOK_AHEAD


def radius(config):
    return {}


def reach(config):
    return {}
'''


def sources(folder=image.FIRMWARE):
    """Hash of all that decides how a run ends: the firmware in the folder, the planners it is compared with, the twin."""
    digest = hashlib.sha256()
    files = [*_firmware(folder), Path(__file__), Path(__file__).with_name("execute.py"), *sorted(BASELINES.rglob("*.py")), _PAPER, *sorted(_TWIN.rglob("*.py"))]
    for path in files:
        digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:12]


def snapshot(expected=None):
    """Copy of the firmware as it is now, so that a change in mid-campaign does no harm; (folder, hash).

    expected: hash that it must have; ValueError if not, which happens on a cluster's worker whose checkout is another.
    """
    found = sources()
    if expected not in (None, found) and not (BUILD / expected).is_dir():
        raise ValueError(f"this worker has other sources ({found}) than the campaign ({expected}): check out the same version on every worker")
    found = expected or found
    _make(BUILD / found / "own", {})
    return BUILD / found / "own", found


def firmware(planner, expected=None):
    """Folder of the firmware with the planner; made now unless it is there."""
    own, found = snapshot(expected)
    if planner in (plan.AWS, plan.NAWS):
        return own
    target = BUILD / found / planner
    scanning = {"scanning.py": (BASELINES / "common" / "scanning.py").read_text()}
    if planner == plan.RULE24:
        added = {"avoid.py": (BASELINES / "rule24" / "avoid.py").read_text(), "paper.py": _PAPER.read_text()}
    else:
        added = {"avoid.py": (BASELINES / "gap" / "avoid.py").read_text(), "disc.py": _DISC.format(*_DISCS[planner])}
    _make(target, scanning | added, own)
    return target


def _firmware(folder):
    folder = Path(folder)
    return [folder / "main.py", folder / "robot.json", *sorted((folder / "lib").rglob("*.py"))]


def _make(target, changed, source=image.FIRMWARE):
    """A copy of the source with files of lib/ changed or added, put in place in one step."""
    if target.is_dir():
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    work = Path(tempfile.mkdtemp(dir=target.parent))
    for path in _firmware(source):
        place = work / path.relative_to(source)
        place.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, place)
    for name, text in changed.items():
        (work / "lib" / name).write_text(text)
    try:
        os.rename(work, target)
    except OSError:
        shutil.rmtree(work)
