"""Whatever bytes come, parsers and files answer with what they declare: a value, nothing, or their own error. Never a crash, never a hang.

tests/fuzz does the same for as long as one wants, led by what of the code is reached.
"""

import json
import tempfile
from pathlib import Path

import pytest

pytest.importorskip("hypothesis", reason="needs the extra [test]")
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.fuzz import targets

FEW = settings(max_examples=100, deadline=None)
MANY = settings(max_examples=400, deadline=None)

KINDS = st.sampled_from([*range(1, 13), *range(0x41, 0x49), 0, 255])
JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8) | st.sampled_from(["0x41", 2**63, -1, 1e400, "AWS", []]),
    lambda inner: st.lists(inner, max_size=12) | st.dictionaries(st.text(max_size=6), inner, max_size=4), max_leaves=20,
)  # fmt: skip
FIELDS = [
    "session", "robot", "board", "firmware", "full_speed", "type", "counter", "key", "value", "width", "spacings", "lidar", "reasons", "faults", "of",
    "number",
]  # fmt: skip
TOLD = st.fixed_dictionaries({"robot": st.just("r"), "board": st.just("00ff")} | {"key": JSON, "value": JSON, "reasons": JSON, "faults": JSON})
TELLING = st.one_of(st.dictionaries(st.sampled_from(FIELDS), JSON), TOLD).map(lambda told: json.dumps(told).encode())


@MANY
@given(st.lists(st.binary(max_size=300), max_size=8))
def test_random_bytes_on_the_wire(pieces):
    targets.wire(pieces)


@MANY
@given(st.lists(st.tuples(KINDS, st.binary(max_size=120)), max_size=6), st.data())
def test_mutated_frames_on_the_wire(messages, data):
    stream = bytearray(b"".join(targets.frame(kind, payload) for kind, payload in messages))
    for _ in range(data.draw(st.integers(0, 4)) if stream else 0):
        stream[data.draw(st.integers(0, len(stream) - 1))] = data.draw(st.integers(0, 255))
    targets.wire([bytes(stream)])


@pytest.mark.parametrize("kind", [*range(1, 13), 0, 0x41, 255])
def test_every_kind_in_every_length(kind):
    for fill in (0, 1, 127, 255):
        for length in range(200):
            targets.message(kind, bytes([fill]) * length)


@MANY
@given(KINDS, st.binary(max_size=24), TELLING)
def test_what_is_told_as_json(kind, before, text):
    targets.message(kind, text)
    targets.message(kind, before + text)
    targets.message(1, bytes(20) + text)
    targets.message(1, bytes(12) + text)


@pytest.mark.parametrize("text", [b"[" * 1300, b'{"a":' * 250, b'{"robot": "r", "board": "0", "width": 1e400}', b'{"robot": "r", "board": "0", "first": NaN}',
                                  b'{"robot": "r", "board": "../../../etc/passwd"}', b"9" * 1300])  # fmt: skip
def test_json_that_breaks_parsers(text):
    for kind in (1, 7, 12):
        targets.message(kind, bytes(20) + text)
        targets.message(kind, text)


@FEW
@given(st.data())
def test_mutated_recordings(data):
    whole = bytearray(targets.whole_recording())
    for _ in range(data.draw(st.integers(1, 5))):
        at = data.draw(st.integers(0, len(whole) - 1))
        what = data.draw(st.sampled_from(["change", "drop", "insert", "cut"]))
        if what == "change":
            whole[at : at + 1] = data.draw(st.binary(min_size=1, max_size=40))
        elif what == "drop":
            del whole[at : at + data.draw(st.integers(1, 60))]
        elif what == "insert":
            whole[at:at] = data.draw(st.binary(max_size=40))
        else:
            del whole[at:]
        if not whole:
            return
    with tempfile.TemporaryDirectory() as folder:
        targets.read_recording(bytes(whole), Path(folder))


@FEW
@given(st.lists(st.tuples(st.integers(0, 255), st.integers(0, 2**64 - 1), st.binary(max_size=60)), max_size=8))
def test_recordings_of_whole_records_that_mean_nothing(records):
    with tempfile.TemporaryDirectory() as folder:
        targets.read_recording(targets.whole_recording(records), Path(folder))


@MANY
@given(st.dictionaries(st.sampled_from(targets.KEYS), JSON, min_size=1, max_size=3))
def test_robot_json_with_random_values(changes):
    targets.robot_json(changes)


@FEW
@given(JSON)
def test_robot_json_that_is_something_else(value):
    targets.robot_text(json.dumps(value).encode())


@pytest.mark.parametrize("text", [b"[" * 100_000, b'{"a":' * 50_000, b"\xff\xfe{\0}\0", b"\xef\xbb\xbf{}", b"null", b"", b'{"mode": "AWS"', b"9" * 5000])
def test_robot_json_that_breaks_parsers(text):
    targets.robot_text(text)


@FEW
@given(st.binary(max_size=200))
def test_robot_json_of_random_bytes(text):
    targets.robot_text(text)
