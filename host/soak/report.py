"""What a campaign has shown so far."""

from collections import Counter

from host.twin import image

from .execute import CONTACT, HANG

PAGE = image.ROOT / "docs" / "safety.md"
BEGIN, END = "<!-- begin: python -m host.soak --write -->", "<!-- end: soak -->"
KIB = 1024
SHOWN = 20  # bad cases


def figures(entries):
    """The sums as a dict that JSON can hold."""
    faulty = [entry for entry in entries if entry["fault_at_s"] is not None]
    heaps = [entry["heap"] for entry in entries if entry["heap"]]
    return {
        "cases": len(entries),
        "robot_hours": round(hours(entries), 3),
        "distance_km": round(sum(entry["distance_m"] for entry in entries) / 1000, 3),
        "faults": len(faulty),
        "contacts_after_fault": sum(entry["contacts_after_fault"] for entry in entries),
        "contacts": sum(entry["contacts"] for entry in entries),
        "stops": sum(entry["stops"] for entry in entries),
        "restarts": sum(entry["restarts"] for entry in entries),
        "hangs": sum(HANG in entry["bad"] for entry in entries),
        "false_faults": dict(sorted(Counter(str(number) for entry in entries for number in entry["false_faults"]).items())),
        "heap_least": min((heap[0] for heap in heaps), default=None),
        "heap_lost_most": max((heap[1] - heap[2] for heap in heaps), default=None),
        "worst_turn_ms": max((entry["worst_ms"] for entry in entries if entry["worst_ms"] is not None), default=None),
        "sources": len({entry["sources"] for entry in entries}),
    }


def hours(entries):
    """Robot hours driven."""
    return sum(entry["time_s"] for entry in entries) / 3600


def markdown(entries):
    """The report: a table, and what went badly."""
    told = figures(entries)
    rows = [
        ("robot time", f"{told['robot_hours']:.2f} h in {told['cases']} cases, {told['faults']} of them with a fault; {told['sources']} states of the sources"),
        ("distance", f"{told['distance_km']:.2f} km"),
        ("contacts after a fault", told["contacts_after_fault"]),
        ("other contacts", told["contacts"]),
        ("hangs that no fault was", told["hangs"]),
        ("faults told where there was none", ", ".join(f"{count} x {number}" for number, count in told["false_faults"].items()) or "none"),
        ("stops of the motors", told["stops"]),
        ("restarts", told["restarts"]),
        ("least heap left", "-" if told["heap_least"] is None else f"{told['heap_least'] / KIB:.1f} KiB"),
        ("most heap lost within a run", "-" if told["heap_lost_most"] is None else f"{told['heap_lost_most']} bytes"),
        ("worst turn of the loop, nothing failing", "-" if told["worst_turn_ms"] is None else f"{told['worst_turn_ms']:.1f} ms"),
    ]
    lines = ["| what | |", "|---|---|", *(f"| {what} | {value} |" for what, value in rows)]
    bad = [entry for entry in entries if entry["bad"]]
    if bad:
        lines += ["", f"{len(bad)} cases went badly:", ""]
        lines += [f"- {_line(entry)}" for entry in bad[:SHOWN]]
        if len(bad) > SHOWN:
            lines.append(f"- and {len(bad) - SHOWN} more")
    return "\n".join(lines)


def _line(entry):
    case = entry["case"]
    shape = f"gap {case['gap']:.0f}" if case["course"] == "random" else f"{case['width']:.0f} mm"
    fault = f", {case['fault']}" if case["fault"] else ""
    return f"case {case['number']} of campaign {case['campaign']} ({case['course']}, {shape}, {case['mode']}{fault}): {'; '.join(entry['bad'])}"


def broken(entries):
    """Those in which a promise was broken. A contact of a robot in which nothing fails is the planner's, and only counted."""
    return [entry for entry in entries if set(entry["bad"]) - {CONTACT}]


def write(text, page=PAGE):
    """Put the report between its two marks in the page. ValueError if they are not there."""
    head, begin, rest = page.read_text().partition(BEGIN)
    _, end, tail = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"{page} has no place for the report: between {BEGIN} and {END}")
    page.write_text(f"{head}{BEGIN}\n{text}\n{END}{tail}")
