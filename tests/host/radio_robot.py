"""A robot with a radio and nothing else, for MicroPython: the firmware's own link over real sockets. Arguments: folder of the firmware's
modules, UDP port. Prints each change of what it is asked to do, with its time in us."""

import json
import sys
import time
from array import array

sys.path.insert(0, sys.argv[1])

import socket

from link.auth import Signer
from link.link import Link
from link.radio import Datagrams
from link.telemetry import Encoder


class Wlan:
    def isconnected(self):
        return True


class Config:
    lidar_frames = 16
    axles = 1
    servos_trims = array("h", [0, 0])
    live = ()


class Steering:
    n = 1
    angles = array("h", [0, 0])
    shares = array("h", [0, 0])
    folded = 0


class Part:
    decisions = mode = af = ar = window = zone = free = why = points_count = v256 = x = y = heading = speed20 = frames = errors = 0
    speed_faults = uptime_ms = heap_free = worst_us = battery_mv = fault = battery_low = lost = 0
    v = 90
    block_x = block_y = 32767
    points_x = points_y = array("H")
    points_window = bytearray()
    points_ordered = True
    steering = Steering
    ok = chips = True


class Drive(Part):
    fault = ""

    @staticmethod
    def stop():
        pass


class Safety:
    state = 1
    fault = 0

    @classmethod
    def start(cls, state):
        cls.state = state
        return True

    @classmethod
    def stop(cls):
        cls.state = 0


class Robot:
    avoid = odometry = lidar = health = Part
    safety = Safety
    feed = bool
    drive = Drive
    took_us = 0
    goal = None


encoder = Encoder()
carrier = Datagrams(Wlan(), socket, int(sys.argv[2]), encoder)
identity = {"robot": "gapseeker-0000", "board": "00ff", "firmware": "0"}


link = Link(Config, json.dumps(identity).encode(), encoder, [carrier], b"12345678", Safety, Signer(bytes(range(32))))
last = None
while True:
    now = time.ticks_us()
    link.update(now, Robot)
    if link.state != last:
        last = link.state
        print(now, last)
    time.sleep_ms(5)
