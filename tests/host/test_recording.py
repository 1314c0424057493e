"""The recording file: what is written is read back, and a damaged file is read up to the damage."""

import json
import struct
import zlib

import pytest

from host.recording import MAGIC, Decision, Header, Inputs, Pose, Reader, RecordingError, Stream, Writer, without_secrets

HEADER = Header("1.2.3", '{ "axles": 5 }\n', "twin:z?width=550", reasons=("the way is free", "Wand rechts, größer"), notes={"seed": 3})
DECISION = Decision(70_000, -900, 900, 180, 4, 2, 255, 32767, -250, 32767, 9)
POSE = Pose(-12.5, 1630.25, 359.9)
RECORDS = [
    (1_000, Stream.LIDAR, bytes(range(256))),
    (1_000, Stream.LIDAR, b""),
    (20_000, Stream.REGISTERS, b"\x40\x06\x00\x00\x33\x01"),
    (21_000, Stream.DECISION, DECISION.pack()),
    (2**33, Stream.POSE, POSE.pack()),
]


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "deeper" / "drive.rec"
    with Writer(path, HEADER) as writer:
        for time_us, stream, data in RECORDS:
            writer.write(stream, time_us, data)
    return path


def test_round_trip(path):
    reader = Reader(path)
    assert reader.header == HEADER
    assert list(reader) == RECORDS
    assert reader.cut is None


def test_payloads_survive(path):
    reader = Reader(path)
    assert [Decision.unpack(r.data) for r in reader.stream(Stream.DECISION)] == [DECISION]
    assert [Pose.unpack(r.data) for r in reader.stream(Stream.POSE)] == [POSE]


def test_events_and_inputs(tmp_path):
    inputs = Inputs(1 << 39 | 1, 65535, (0x40, 0x41, 0x77))
    with Writer(tmp_path / "a.rec", HEADER) as writer:
        writer.event(5, "touched the wall at 12 °")
        writer.write(Stream.INPUTS, 6, inputs.pack())
    event, change = Reader(tmp_path / "a.rec")
    assert event.data.decode() == "touched the wall at 12 °"
    assert Inputs.unpack(change.data) == inputs


def test_every_cut_is_read_up_to_the_cut(path, tmp_path):
    """Cut at every byte: the whole records before the cut come back, and the cut is reported."""
    whole = path.read_bytes()
    short = tmp_path / "short.rec"
    counts = []
    for length in range(len(whole)):
        short.write_bytes(whole[:length])
        try:
            reader = Reader(short)
        except RecordingError:
            counts.append(-1)
            continue
        got = list(reader)
        assert got == RECORDS[: len(got)]
        assert "cut off at byte" in reader.cut
        counts.append(len(got))
    assert counts == sorted(counts) and counts[-1] == len(RECORDS)


def test_damage_at_the_end_stops_the_reading(path):
    whole = bytearray(path.read_bytes())
    whole[-40] ^= 1
    path.write_bytes(whole)
    reader = Reader(path)
    assert list(reader) == RECORDS[:-1]
    assert "damaged at byte" in reader.cut


def test_an_impossible_length_is_damage(path):
    whole = path.read_bytes()
    path.write_bytes(whole + b"\x01" + bytes(8) + b"\xff\xff\xff\xff")
    assert list(Reader(path)) == RECORDS  # the end mark comes first
    path.write_bytes(whole[:-17] + b"\x01" + bytes(8) + b"\xff\xff\xff\xff")
    reader = Reader(path)
    assert list(reader) == RECORDS and "cannot be" in reader.cut


def test_records_are_readable_before_the_writer_closes(tmp_path):
    writer = Writer(tmp_path / "a.rec", HEADER)
    writer.write(Stream.LIDAR, 1, b"abc")
    reader = Reader(tmp_path / "a.rec")
    assert [r.data for r in reader] == [b"abc"]
    assert "after a whole record" in reader.cut
    writer.close()
    writer.close()


def test_a_recording_is_never_overwritten(path):
    before = path.read_bytes()
    with pytest.raises(RecordingError, match="exists already"):
        Writer(path, HEADER)
    assert path.read_bytes() == before


@pytest.mark.parametrize("content", [b"", b"hello", MAGIC, MAGIC.replace(b"\r\n", b"\n") + bytes(40)])
def test_other_files_are_refused(tmp_path, content):
    (tmp_path / "x").write_bytes(content)
    with pytest.raises(RecordingError):
        Reader(tmp_path / "x")


def test_missing_file(tmp_path):
    with pytest.raises(RecordingError, match="cannot read"):
        Reader(tmp_path / "none")


def test_a_newer_format_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr("host.recording.FORMAT", 2)
    Writer(tmp_path / "n.rec", HEADER).close()
    monkeypatch.undo()
    with pytest.raises(RecordingError, match="format 2"):
        Reader(tmp_path / "n.rec")


def many(path, count=400):
    records = [(20_000 * i, Stream.LIDAR if i % 3 else Stream.EVENT, bytes([i % 256]) * (i % 50 + 1)) for i in range(count)]
    with Writer(path, HEADER) as writer:
        for time_us, stream, data in records:
            writer.write(stream, time_us, data)
    return records


def test_damage_in_the_middle_loses_what_it_hits_and_no_more(tmp_path):
    """Forty bad bytes anywhere: a few records are gone, what follows is read, and the place is told."""
    path = tmp_path / "a.rec"
    records = many(path)
    whole = path.read_bytes()
    for at in range(2000, len(whole) - 1000, 977):
        path.write_bytes(whole[:at] + bytes(255 - byte for byte in whole[at : at + 40]) + whole[at + 40 :])
        reader = Reader(path)
        read = list(reader)
        assert len(read) >= len(records) - 6 and read[-1] == records[-1] and all(record in records for record in read)
        assert len(reader.damage) == 1 and "bytes were left out, after" in reader.damage[0]
        place = int(reader.damage[0].split("byte ")[1].split(":")[0])
        assert at - 70 < place < at + 40
        assert reader.cut is None


def test_missing_bytes_lose_no_more_than_their_records(tmp_path):
    path = tmp_path / "a.rec"
    records = many(path)
    whole = path.read_bytes()
    path.write_bytes(whole[:5000] + whole[5100:])
    reader = Reader(path)
    assert len(list(reader)) >= len(records) - 8
    assert len(reader.damage) == 1


def test_a_whole_record_that_cannot_be_is_left_out(tmp_path):
    with Writer(tmp_path / "a.rec", HEADER) as writer:
        writer.write(Stream.DECISION, 1, b"short")
        writer.write(Stream.POSE, 2, Pose(float("nan"), 0, 0).pack())
        writer.write(Stream.INPUTS, 3, b"")
        writer.write(Stream.READ, 4, b"")
        writer.write(Stream.LIDAR, 5, b"abc")
    reader = Reader(tmp_path / "a.rec")
    assert list(reader) == [(5, Stream.LIDAR, b"abc")]
    assert len(reader.damage) == 4 and all("damaged at byte" in text for text in reader.damage)


@pytest.mark.parametrize("header", [b"", b"null", b"[]", b"{", b"{}", b"[" * 5000, b'{"format": 1}', b'{"format": []}', b"\xff\xfe",
                                    b'{"format": 1, "firmware": "1", "robot": null, "source": "", "clock": "robot", "reasons": [], "notes": {}}'])  # fmt: skip
def test_a_header_that_is_none_is_told_with_its_place(tmp_path, header):
    path = tmp_path / "a.rec"
    body = struct.pack("<BQI", Stream.HEADER, 0, len(header)) + header
    path.write_bytes(MAGIC + body + struct.pack("<I", zlib.crc32(body)))
    with pytest.raises(RecordingError, match="byte 8|format"):
        Reader(path)


SECRET = 'se"cret}1 \\u0041'


@pytest.mark.parametrize("text", [
    json.dumps({"wifi": {"ssid": "home", "password": SECRET, "port": 1}}),
    json.dumps({"wifi": {"ssid": "home", "password": SECRET}}, indent=1) + "}",
    json.dumps({"wifi": {"password": SECRET}}).replace("password", "p\\u0061ssword"),
])  # fmt: skip
def test_the_password_of_the_wifi_is_in_no_recording(tmp_path, text):
    with Writer(tmp_path / "a.rec", Header("1", text, "twin:z")):
        pass
    assert b"cret" in text.encode() and b"cret" not in (tmp_path / "a.rec").read_bytes()


def test_without_a_password_robot_json_stays_as_it_was():
    assert without_secrets(HEADER.robot) == HEADER.robot
    text = '{ "wifi": {"password":   "", "ssid": ""} }'
    assert without_secrets(text) == text
