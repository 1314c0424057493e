"""Bytes that mean nothing, by the ten thousand, into everything on the robot that takes bytes: no exception, and the heap is as it was.

Half of them are whole frames with a right check around what means nothing, as nothing else gets far.
"""

import gc
import struct

import test_lidar
import test_link

from lidar import Lidar
from link.auth import Signer
from link.frames import frame
from link.telemetry import Decoder

ROUNDS = 400


class Random:
    """Bytes from a linear congruential generator: the same on both interpreters."""

    def __init__(self, seed):
        self.state = seed

    def number(self, below):
        self.state = (self.state * 1_103_515_245 + 12_345) & 0x3FFFFFFF
        return (self.state >> 12) % below

    def bytes(self, count):
        return bytes([self.number(256) for _ in range(count)])


def level(act):
    """How much of the heap is taken after each tenth of the rounds; under CPython nothing is counted."""
    levels = []
    for k in range(ROUNDS):
        act(k)
        if k % (ROUNDS // 10) == ROUNDS // 10 - 1 and hasattr(gc, "mem_alloc"):
            gc.collect()
            levels.append(gc.mem_alloc())
    return levels


def assert_flat(levels):
    """A block or two come and go with what the last round left; growth would add up."""
    if levels:
        assert levels[-1] <= levels[1] + 1024, levels


def test_the_lidar_s_parser():
    random = Random(1)
    uart = test_lidar.Uart()
    lidar = Lidar(uart, None, test_lidar.Config)

    def act(k):
        data = random.bytes(random.number(400))
        if k % 2:
            points = [(random.number(65536), random.number(256)) for _ in range(random.number(60))]
            data += test_lidar.make_frame(random.number(36000), points, random.number(256), random.number(2))
        uart.give(data)
        for _ in range(100):
            if not lidar.poll(k * 10_000):
                break
            assert 0 <= lidar.n <= len(lidar.bearings)
            for i in range(lidar.n):
                assert 0 <= lidar.bearings[i] < 3600
        else:
            raise AssertionError("it never comes to an end")

    assert_flat(level(act))


def test_the_decoder_of_frames():
    random = Random(2)
    decoder = Decoder(200)

    def act(k):
        data = bytearray(random.bytes(random.number(300)))
        if k % 2:
            data += frame(random.number(256), random.bytes(random.number(210)), k)
            data[random.number(len(data))] = random.number(256)
        for byte in data:
            more = decoder.add(byte)
            while more:
                assert 8 <= decoder.end <= 208
                more = decoder.take()
        decoder.load(data, len(data))
        while decoder.take():
            pass

    assert_flat(level(act))


def commands(signed, seed):
    """Random commands through the whole link; those over the network have a right tag every other time."""
    random = Random(seed)
    link, line, robot = test_link.make(signed=signed)
    signer = Signer(test_link.KEY)

    def act(k):
        del robot.tuned[:]
        kind = 0x40 + random.number(10)
        if kind == 0x48:
            kind = 0x47  # it would start anew
        payload = struct.pack("<I", k + 1) + random.bytes(random.number(190))
        if signed and k % 4:
            body = struct.pack("<BBHH", 1, kind, k, len(payload) + 8) + payload
            payload += signer.tag(test_link.SESSION, body)
        data = bytearray(frame(kind, payload, k) if k % 5 else random.bytes(200))
        if k % 7 == 0:
            data[random.number(len(data))] = random.number(256)
        line.receive(bytes(data))
        now = k * 3_000_000
        for turn in range(6):
            link.update(now + turn * 10_000 & 0x3FFFFFFF, robot)
        link.update(now + 2_500_000 & 0x3FFFFFFF, robot)  # what was loaded for a rare command is let go
        line.used = 0
        assert link.state in (0, 1, 2) and -900 <= link.af <= 900 and -900 <= link.ar <= 900 and 0 <= link.v <= 180

    assert_flat(level(act))
    assert link.refused > ROUNDS // 10


def test_commands_over_the_cable():
    commands(False, 3)


def test_commands_over_the_network():
    commands(True, 4)
