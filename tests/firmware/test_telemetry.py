"""telemetry.py: frames out of what a line delivers."""

import struct

import micropython

from link import telemetry
from link.frames import decode, frame
from link.telemetry import Decoder, Encoder


def test_a_frame_comes_back():
    data = frame(telemetry.LOG, b"\x00hello", 7)
    assert data[:4] == b"\xf7\xf6\x01\x08"
    assert decode(data) == [(telemetry.LOG, 7, b"\x00hello")]


def test_encoder_makes_the_same_bytes():
    encoder = Encoder()
    for sequence in range(3):
        struct.pack_into(telemetry.POSE_FORMAT, encoder.data, telemetry.HEADER, 1, -2, 3, 359999)
        size = encoder.seal(telemetry.POSE, 16)
        assert bytes(encoder.data[:size]) == frame(telemetry.POSE, struct.pack(telemetry.POSE_FORMAT, 1, -2, 3, 359999), sequence)


def test_longest_frame_fits_a_datagram():
    data = frame(telemetry.SCAN, bytes(telemetry.MAX_PAYLOAD))
    assert len(data) == telemetry.MAX_FRAME == 1400
    assert len(decode(data)[0][2]) == telemetry.MAX_PAYLOAD


def test_text_between_frames_is_stray():
    heard = []
    decoder = Decoder(stray=heard.append)
    data = b"Traceback\r\n" + frame(2, b"a") + b"MPY: soft reboot" + frame(3, b"b")
    decoder.feed(data, 0, len(data))
    assert decoder.take() and decoder.kind == 2
    assert decoder.take() and decoder.kind == 3
    assert not decoder.take() and not decoder.waiting()
    assert bytes(heard) == b"Traceback\r\nMPY: soft reboot"


def test_one_byte_at_a_time():
    data = b"x" + frame(4, b"12345", 300)
    decoder = Decoder()
    for i in range(len(data)):
        assert not decoder.take()
        decoder.feed(data, i, 1)
    assert decoder.take() and decoder.sequence == 300
    assert bytes(decoder.data[decoder.start : decoder.end]) == b"12345"


def test_any_flipped_bit_is_noticed_and_the_next_frame_found():
    first, second = frame(5, b"first message"), frame(6, b"second", 1)
    for at in range(len(first)):
        for bit in range(8):
            broken = bytearray(first)
            broken[at] ^= 1 << bit
            found = decode(bytes(broken) + second + bytes(1500))
            assert found == [(6, 1, b"second")], (at, bit)


def test_a_frame_cut_off_by_another():
    whole = frame(5, b"0123456789")
    for cut in range(1, len(whole)):
        assert decode(whole[:cut] + whole + bytes(1400))[-1] == (5, 0, b"0123456789")


def test_a_length_beyond_the_buffer_is_no_frame():
    decoder = Decoder(max_payload=64)
    data = frame(5, bytes(65)) + frame(6, bytes(64))
    at = 0
    while True:
        if decoder.take():
            break
        count = min(decoder.room(), len(data) - at)
        decoder.feed(data, at, count)
        at += count
    assert decoder.kind == 6


def test_an_unfinished_frame_can_be_cleared():
    heard = []
    decoder = Decoder(stray=heard.append)
    data = frame(5, b"\x03 is Ctrl-C")[:14]
    decoder.feed(data, 0, len(data))
    assert not decoder.take() and decoder.waiting()
    decoder.clear()
    assert 3 in heard and not decoder.waiting()


def test_encoding_and_decoding_allocate_nothing():
    encoder = Encoder()
    decoder = Decoder(64)
    size = encoder.seal(telemetry.GREET, 4)
    decoder.room()
    micropython.heap_lock()
    try:
        k = 0
        found = 0
        while k < 20:
            struct.pack_into(telemetry.DECISION_FORMAT, encoder.data, 8, k, 5, 1, 2, -3, 4, 5, 6, 7, 8, 9, 10, 11, 12)
            size = encoder.seal(telemetry.DECISION, 31)
            decoder.room()
            decoder.feed(encoder.data, 0, size)
            while decoder.take():
                found += 1
            k += 1
    finally:
        micropython.heap_unlock()
    assert found == 20
