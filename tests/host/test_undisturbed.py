"""What others do to the link must not show in what the robot does: telemetry, a screen, WiFi, strangers who flood it."""

import shutil
from math import inf

import pytest

from host.link import messages
from host.twin import Observer, image, run
from host.twin.faults import KINDS, base
from host.twin.faults.board import Flood
from link import frames as whole_frames
from link import protocol


class Stream(Observer):
    """Every write to a chip, with its time; and how many bytes the link and the screen gave out."""

    def __init__(self):
        self.writes, self.told, self.shown = [], 0, 0

    def registers(self, time, address, data):
        self.writes.append((time, address, bytes(data)))

    def serial(self, data):
        self.told += len(data)

    def uart(self, time, gpio, data):
        self.shown += len(data)


def test_the_registers_are_the_same_with_telemetry_screen_wifi_and_a_flood(tmp_path, monkeypatch):
    """Where computing takes no time, to the byte and the microsecond."""
    silent = tmp_path / "firmware"
    shutil.copytree(image.FIRMWARE, silent, ignore=shutil.ignore_patterns("__pycache__"))
    main = (silent / "main.py").read_text()
    (silent / "main.py").write_text(main.replace("del start\n", "del start\nrobot.link = None\n"))
    monkeypatch.setitem(KINDS, "flood-free", base.Kind("flood-free", "", None, None, Flood, {"rate": 10_000, "timed": False}))
    # A fault's beginning makes the twin stop once more; in the other run nothing begins at the same time.
    monkeypatch.setitem(KINDS, "nothing", base.Kind("nothing", "", None, None, base.Fault, {}))
    alone, busy = Stream(), Stream()
    settings = dict(seed=1, chip=inf, record=False, limit_s=9)
    run("Z", 550, watch=alone, firmware=silent, fault="nothing@2", **settings)
    run("Z", 550, watch=busy, fault="flood-free@2", changes={"screen.kind": "nextion"}, heap=4 << 20, **settings)
    assert alone.told == alone.shown == 0 and busy.told > 10_000 and busy.shown > 1000
    assert len(alone.writes) > 500 and busy.writes == alone.writes


class Watcher(Observer):
    """Asks for the times of the turns from 4 s on."""

    def __init__(self):
        self.said, self.now, self.asked = b"", 0.0, False

    def step(self, simulation):
        self.now = simulation.now

    def serial(self, data):
        self.said += data

    def commands(self):
        if self.now < 4e6 or self.asked:
            return b""
        self.asked = True
        return whole_frames.frame(protocol.WATCH, messages.watch(1, False, False, True))

    def turns(self, start):
        """TURNS told after that time, s."""
        told = [messages.decode(kind, payload) for kind, _, payload in whole_frames.decode(self.said) if kind == protocol.TURNS]
        return [one for one in told if one["time"] > start]


def test_a_flood_of_10000_datagrams_a_second_takes_no_time_to_speak_of():
    """Where computing takes its time, checking tags included: a turn that has been long leaves them alone, and after a wrong one nothing is heard for a while."""
    flooded, quiet = Watcher(), Watcher()
    wifi = {"wifi.ssid": "net", "wifi.password": "12345678"}
    done = run("Z", 550, seed=1, watch=flooded, chip=1.0, record=False, limit_s=11, fault="flood-10000@5")
    run("Z", 550, seed=1, watch=quiet, chip=1.0, record=False, limit_s=11, changes=wifi)
    assert done.fault.driven_after_s > 2 and not done.contacts
    link = [sum(one["sums"][4] for one in watcher.turns(5.5)) / sum(sum(one["sums"]) for one in watcher.turns(5.5)) for watcher in (flooded, quiet)]
    assert link[0] < link[1] + 0.1, link  # a tenth of the time at most
    assert max(one["most"][4] for one in flooded.turns(5.5)) < 6
    assert len(flooded.turns(5.5)) >= 9  # the link goes on telling, however often strangers call


@pytest.mark.parametrize("rate", [300, 10_000])
def test_the_flood_is_there(rate):
    flooded = Watcher()
    run("Z", 550, seed=1, watch=flooded, chip=1.0, record=False, limit_s=7, fault=f"flood{'-10000' * (rate > 300)}@4")
    health = [messages.decode(kind, payload) for kind, _, payload in whole_frames.decode(flooded.said) if kind == protocol.HEALTH]
    assert health[-1]["refused"] > 20
