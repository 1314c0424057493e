"""A comparison in words."""

from host.recording import Decision
from host.twin.console import WINDOWS

from .compare import Comparison, Difference

WIDTH = 72
BYTES = 4  # differing registers of one write to name


def summary(what: str, comparison: Comparison) -> str:
    """One line: how many were compared, how many differ, since when."""
    if not comparison.differences:
        return f"{comparison.compared} {what} compared: all the same"
    first = comparison.differences[0].time_us / 1e6
    return f"{comparison.compared} {what} compared: {len(comparison.differences)} differ, the first at {first:.3f} s"


def decisions(comparison: Comparison, reasons: tuple[str, ...], rows: int) -> list[str]:
    """A table of the first differing decisions."""
    if not comparison.differences:
        return []
    lines = [f"{'time s':>9}  {'then':<{WIDTH}}  now"]
    for difference in comparison.differences[:rows]:
        then, now = _words(difference.then, reasons), _words(difference.now, reasons)
        lines.append(f"{difference.time_us / 1e6:9.3f}  {then:<{WIDTH}}  {now}")
    if more := len(comparison.differences) - rows:
        lines += [f"{'...':>9}  {more} more (--rows N shows N)"] * (more > 0)
    return lines


def write(difference: Difference) -> str:
    """One differing I2C write: the registers that differ, or both whole if they are not alike."""
    text = f"at {difference.time_us / 1e6:.6f} s: "
    then, now = difference.then, difference.now
    if then and now and then != now and then[0] == now[0] and len(then[1]) == len(now[1]) and then[1][:1] == now[1][:1]:
        start = then[1][0]
        unlike = [(start + i - 1, old, new) for i, (old, new) in enumerate(zip(then[1], now[1])) if old != new]
        text += f"chip 0x{then[0]:02x}, " + ", ".join(f"register 0x{at:02x}: then {old:02x}, now {new:02x}" for at, old, new in unlike[:BYTES])
        return text + (f" and {len(unlike) - BYTES} more" if len(unlike) > BYTES else "")
    if then == now:
        return text + "the same bytes at another time"
    return text + f"then {_bytes(then)}; now {_bytes(now)}"


def _words(decision: Decision | None, reasons: tuple[str, ...]) -> str:
    if decision is None:
        return "no decision"
    text = f"AF {decision.af / 10:5.1f} AR {decision.ar / 10:5.1f} V {decision.v:3d}"
    if 0 < decision.window < len(WINDOWS):
        text += f" {WINDOWS[decision.window]}"
    if decision.zone < 10:
        text += f" zone {decision.zone}"
    text += f" free {decision.free}"
    return text + (f" {reasons[decision.why]}" if decision.why < len(reasons) else f" reason {decision.why}")


def _bytes(content: tuple[int, bytes] | None) -> str:
    if content is None:
        return "nothing"
    address, data = content
    return f"{len(data) - 1} bytes to chip 0x{address:02x} from register 0x{data[0]:02x} on" if data else f"nothing to chip 0x{address:02x}"
