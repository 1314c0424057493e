"""The whole loop, lidar bytes to chip registers, with the heap locked: it must not allocate."""

import sys

import micropython
import rooms
from fake_chips import FakeBus, FakePin

import robot as loop
from actuation.drive import Drive
from avoid import Avoid
from core.axles import lay_out
from lidar import Lidar
from params.config import Config
from pca9685 import PCA9685
from planner.decision import REST
from safety.health import Health
from safety.safety import Safety

# The emulation of viper is a hundred times slower: there the loop is only run to see that it can be.
_TURNS = 20 if sys.implementation.name == "micropython" else 2

# left, right, front, rear: free way, wall ahead, dead end, hardly any room, wall on one side only
_ROOMS = ((350, 350, 4000, 1500), (350, 900, 560, 2000), (260, 260, 480, 1200), (215, 215, 340, 345), (240, 2000, 3000, 3000))


class _Clock:
    def __init__(self):
        self.now = 0

    def __call__(self):
        return self.now


class _Line(rooms.Uart):
    """Has a frame when told so, once."""

    def __init__(self, data):
        rooms.Uart.__init__(self, data)
        self.waiting = False

    def readinto(self, buffer):
        if not self.waiting:
            return None
        self.waiting = False
        self._at = (self._at + 1) // 2 * 2 % (2 * rooms.FRAMES)
        return rooms.Uart.readinto(self, buffer)


def _robot(mode, clock):
    config = Config({"mode": mode})
    bus = FakeBus()
    chips = [PCA9685(bus, address, frequency) for address, frequency in ((0x40, 50), (0x41, 1000), (0x42, 1000))]
    drive = Drive(lay_out(config.axles_spacings, config.axles_track, config.axles_first), chips[0], chips[1], chips[2], FakePin(), config)
    lidar = Lidar(_Line(bytes(rooms.FRAMES * rooms.FRAME_SIZE)), None, config)
    loop.ticks_us = clock
    health = Health(drive, None, config)
    return loop.Robot(config, Avoid(config), lidar, drive, Safety(lidar, drive, health, None, None, True), health), bus


def _run(mode):
    """(robot, bus, bits of the stages of a decision seen)."""
    clock = _Clock()
    robot, bus = _robot(mode, clock)
    scans = [rooms.revolution(*room) for room in _ROOMS]
    stages = 0
    uart = robot.lidar.uart
    avoid = robot.avoid
    turn = 0
    micropython.heap_lock()
    try:
        while turn < len(_ROOMS) * _TURNS:
            uart.data = scans[turn // _TURNS]
            frame = 0
            while frame < rooms.FRAMES:
                uart.waiting = True
                clock.now += rooms.FRAME_US - 3000
                for _ in range(4):  # the frame, the chips, slices of the decision
                    robot.step()
                    stages |= 1 << avoid.decision.stage
                    clock.now += 1000
                clock.now -= 1000
                frame += 1
            turn += 1
    finally:
        micropython.heap_unlock()
    return robot, bus, stages


def _check(mode):
    robot, bus, stages = _run(mode)
    assert robot.safety.failures == 0 and robot.safety.fault == 0
    assert robot.lidar.errors == 0 and robot.lidar.frames == len(_ROOMS) * _TURNS * rooms.FRAMES
    if _TURNS > 2:
        assert robot.avoid.decisions > 15, robot.avoid.decisions
        assert stages == (1 << len(robot.avoid.decision.STAGES)) - 1, bin(stages)
        assert bus.chips[0x40].running() and bus.chips[0x41].bursts > 20


def test_a_turn_says_whether_the_next_should_come_at_once():
    """After a frame, and while a decision is under way, no time is slept away; at rest, and after some slices without a frame, it is."""
    clock = _Clock()
    robot, _ = _robot("AWS", clock)
    scan = rooms.revolution(*_ROOMS[0])
    uart = robot.lidar.uart
    uart.data = scan
    most = 0
    for _ in range(2 * rooms.FRAMES):
        uart.waiting = True
        clock.now += rooms.FRAME_US
        assert robot.step() or robot.safety.fault  # a frame, which a decision follows
        turns = 0
        while robot.step():
            turns += 1
        decision = robot.avoid.decision
        assert turns >= 5 or robot.safety.fault or decision.stage == REST and not decision.renewing
        assert turns <= 6  # and the last of six slices, the chips being written once
        most = max(most, turns)
    assert most and not robot.safety.fault
    uart.waiting = True
    assert robot.step()
    robot.safety.stop()  # in the middle of a decision
    assert not robot.step()


def test_the_loop_goes_through_all_stages_in_a_locked_heap():
    _check("AWS")


def test_so_it_does_with_the_last_axle_straight():
    _check("NAWS")
