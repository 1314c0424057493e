"""Fits the prices that the twin charges for computing (host/twin/board/prices.py) to the instructions that the firmware executes."""

import pprint
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from host.link import messages
from host.twin import image

from . import scans
from .measure import Bench

WORKERS = 2
TABLE = image.BOARD / "prices.py"
MADE = "avoid:Avoid.__init__"
PART = 16  # the prices of work are in 16ths of an instruction
COURSES = (
    {"course": "Z", "width": 550, "seed": 3, "limit_s": 10},
    {"course": "Z", "width": 450, "seed": 2, "limit_s": 10},
    {"course": "Z", "width": 580, "seed": 1, "mode": "naws", "limit_s": 10},
    {"course": "U", "width": 600, "seed": 1, "limit_s": 10, "changes": {"screen.kind": "nextion"}},
    {"course": "random", "gap": 400, "seed": 1, "limit_s": 10},
    {"course": "random", "gap": 300, "seed": 2, "limit_s": 10},
)

_SUBSETS = ([0], [1], [2], [0, 1], [0, 2], [1, 2], [0, 1, 2])  # of the call and its two kinds of work, the plainest first

_HEAD = '''"""What the firmware's methods take on the ESP32, in instructions: fitted to executed ones by `python -m host.bench --calibrate --write`.

See charge.py for how they are charged, docs/bench.md for how they are counted.
"""

# Loading a module: `import avoid` of 22 November, with what it imports, took 1.5 s on the emulated chip at 8 ns an instruction.
IMPORT = {IMPORT}
IMPORT_BYTE = {IMPORT_BYTE}  # of its .mpy
FILE_BYTE = {FILE_BYTE}  # of a file that is read as it is
COLLECT = {COLLECT}  # a collection of garbage, or a question for the size of the heap, which takes as long

# {{method: (a call, each of its first kind of work in 16ths, each of its second in 16ths)}}
OF = {table}
'''


def rows(courses=COURSES, firmware=image.FIRMWARE, each=None):
    """(names of the methods charged for, (n, 6) int of calls, see board/meter.py) over the courses; on every other one candidates and raw scans are watched."""
    bench = Bench(firmware)
    tapes = [tape for tape in scans.tapes(courses, firmware, WORKERS, twin=False) if not tape.surprise]
    found = [bench.calibrate(tapes[0], tables=False)]
    found[0] = found[0][found[0][:, 0] == names().index(MADE)]  # of this one only how long it takes to make the tables
    with ThreadPoolExecutor(WORKERS) as pool:
        for one in pool.map(bench.calibrate, tapes, [watched() if i % 2 == 0 else b"" for i in range(len(tapes))]):
            found.append(one)
            if each:
                each()
    return names(), np.concatenate(found).astype(np.int64)


def watched():
    """Bytes on the USB line that ask for candidates and raw scans."""
    from link import frames, protocol

    return frames.frame(protocol.WATCH, messages.watch(1, True, True))


def names():
    """Methods that the twin charges for, by their numbers in charge.py."""
    out = []
    for line in (image.BOARD / "charge.py").read_text().splitlines():
        if line.startswith("@_wraps("):
            out.append(line.split('"')[1])
    return out


def fit(named, calls):
    """{method: (a call, each of the first kind of work, each of the second)}, whole numbers; none below 0. Least squares over its calls."""
    out = {}
    for number, name in enumerate(named):
        own = calls[calls[:, 0] == number]
        if not len(own):
            continue
        everything = np.column_stack([np.ones(len(own)), own[:, 2], own[:, 3]]).astype(float)
        wanted = own[:, 1].astype(float)
        best, price = np.inf, np.zeros(3)
        for used in _SUBSETS:
            found, *_ = np.linalg.lstsq(everything[:, used], wanted, rcond=None)
            billed = everything[:, used] @ found
            off = float(((billed - wanted) ** 2).sum())
            if found.min() >= 0 and billed.sum() > 0 and off < best * 0.999:
                best, price = off, np.zeros(3)
                price[used] = found * wanted.sum() / billed.sum()  # what all calls take together is to be right
        out[name] = (round(price[0]), round(price[1] * PART), round(price[2] * PART))
    return out


def charged(named, calls, table):
    """(n,) int: what the twin charges for each call."""
    prices = np.array([table.get(name, (0, 0, 0)) for name in named], np.int64)[calls[:, 0]]
    return prices[:, 0] + (calls[:, 2] * prices[:, 1] + calls[:, 3] * prices[:, 2] >> 4)


def totals(named, calls, table, column):
    """{name: (calls, instructions counted, charged)} by column 0, the method, or 4, the method that is the stage."""
    bill = charged(named, calls, table)
    out = {}
    for number in np.unique(calls[:, column]):
        own = calls[:, column] == number
        out[named[number]] = int(own.sum()), int(calls[own, 1].sum()), int(bill[own].sum())
    return out


def committed():
    """The prices in use, as a namespace."""
    space: dict = {}
    exec(TABLE.read_text(), space)
    return space


def report(named, calls, table):
    """What was counted and what is charged, for each method and each part of the loop."""
    lines = []
    for title, column in (("method", 0), ("part of the loop, with all that it calls", 4)):
        lines += ["", f"{title:62}{'calls':>9}{'counted':>11}{'charged':>11}{'ratio':>7}   (thousands of instructions)"]
        for name, (count, counted, bill) in totals(named, calls, table, column).items():
            lines.append(f"{name:62}{count:9}{counted / 1000:11.0f}{bill / 1000:11.0f}{bill / counted if counted else 1:7.2f}")
    return "\n".join(lines[1:])


def listing(table):
    """Prices as prices.py holds them."""
    lines = pprint.pformat(table, width=140, sort_dicts=False).splitlines()
    return "{\n" + "\n".join("    " + line.strip("{} ").rstrip(",").replace("'", '"') + "," for line in lines) + "\n}"


def write(table, path=None):
    """Put the prices into the twin."""
    Path(path or TABLE).write_text(_HEAD.format(table=listing(table), **committed()))
