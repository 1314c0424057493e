"""telemetry.py: frames out of what a line delivers."""

import struct

import micropython

from link import protocol
from link.frames import FrameReader, StreamDecoder, decode, frame
from link.telemetry import Decoder, Encoder


def test_a_frame_comes_back():
    data = frame(protocol.LOG, b"\x00hello", 7)
    assert data[:4] == b"\xf7\xf6\x01\x08"
    assert decode(data) == [(protocol.LOG, 7, b"\x00hello")]


def test_encoder_makes_the_same_bytes():
    encoder = Encoder()
    for sequence in range(3):
        encoder.data[3] = protocol.POSE
        struct.pack_into(protocol.POSE_FORMAT, encoder.data, protocol.HEADER, 1, -2, 3, 359999)
        encoder.seal(16)
        assert bytes(encoder.data[: encoder.size]) == frame(protocol.POSE, struct.pack(protocol.POSE_FORMAT, 1, -2, 3, 359999), sequence)


def test_longest_frame_fits_a_datagram():
    data = frame(protocol.SCAN, bytes(protocol.MAX_PAYLOAD))
    assert len(data) == protocol.MAX_FRAME == 1400
    assert len(decode(data)[0][2]) == protocol.MAX_PAYLOAD


def test_text_between_frames_is_stray():
    heard = []
    reader = FrameReader(heard.append)
    data = b"Traceback\r\n" + frame(2, b"a") + b"MPY: soft reboot" + frame(3, b"b")
    assert [kind for kind, _, _ in reader.read(data)] == [2, 3]
    assert bytes(heard) == b"Traceback\r\nMPY: soft reboot"


def test_one_byte_at_a_time():
    data = b"x" + frame(4, b"12345", 300)
    decoder = StreamDecoder(16)
    for byte in data[:-1]:
        assert not decoder.add(byte) and not decoder.take()
    assert decoder.add(data[-1])
    assert (decoder.kind, decoder.sequence, bytes(decoder.data[8 : decoder.end])) == (4, 300, b"12345")
    assert not decoder.take() and not decoder.waiting()


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
    decoder = Decoder(64)
    found = [decoder.kind for byte in frame(5, bytes(65)) + frame(6, bytes(64)) if decoder.add(byte)]
    assert found == [6]


def test_frames_swallowed_by_a_broken_one_are_found_one_after_the_other():
    broken = bytearray(frame(5, bytes(40)))
    broken[-1] ^= 1
    small = b"".join([frame(6, b"", k) for k in range(4)])
    data = bytes(broken[:12]) + small + bytes(50)
    decoder = StreamDecoder(64)
    found = []
    for byte in data:
        more = decoder.add(byte)
        while more:
            found.append(decoder.sequence)
            more = decoder.take()
    assert found == [0, 1, 2, 3] and decoder.errors == 1


def test_a_datagram_replaces_what_there_was():
    decoder = Decoder(64)
    whole = frame(5, b"abc")
    assert not decoder.load(whole[:9], 9) and decoder.waiting()
    assert decoder.load(whole + bytes(50), len(whole) + 50) and bytes(decoder.data[8 : decoder.end]) == b"abc"
    assert not decoder.load(bytes(300), 300)
    assert decoder.load(b"xx" + whole, len(whole) + 2)


def test_an_unfinished_frame_can_be_cleared():
    heard = []
    decoder = StreamDecoder(64, heard.append)
    for byte in frame(5, b"\x03 is Ctrl-C")[:14]:
        assert not decoder.add(byte)
    assert decoder.waiting()
    decoder.clear()
    assert 3 in heard and not decoder.waiting()


def test_encoding_and_decoding_allocate_nothing():
    encoder = Encoder()
    decoder = Decoder(64)
    encoder.data[3] = protocol.DECISION
    encoder.seal(4)
    micropython.heap_lock()
    try:
        k = 0
        found = 0
        while k < 20:
            struct.pack_into(protocol.DECISION_FORMAT, encoder.data, 8, k, 5, 1, 2, -3, 4, 5, 6, 7, 8, 9, 10, 11, 12)
            encoder.seal(28)
            i = 0
            while i < encoder.size:
                if decoder.add(encoder.data[i]):
                    found += 1
                i += 1
            k += 1
    finally:
        micropython.heap_unlock()
    assert found == 20
