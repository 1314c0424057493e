"""start.py: what the link is put together from."""

import os

from link import start

KEY_FILE = "network.key"


class Config:
    wifi_ssid = "workshop"
    wifi_port = 9750
    robot_width = 250
    robot_length = 600
    axles_track = 230
    axles_spacings = (115,)
    axles_first = 248
    motors_full_speed = 1280
    lidar_x = lidar_y = 0
    lidar_frames = 16


class Machine:
    @staticmethod
    def unique_id():
        return b"\x00\xff"

    @staticmethod
    def reset_cause():
        return 1


def started(key):
    """The link where network.key holds these bytes; None: where there is no such file."""
    before = start.SerialLine
    start.SerialLine = object  # the real one takes the console
    try:
        if key is not None:
            with open(KEY_FILE, "wb") as file:
                file.write(key)
        return start.start_link(Config, Machine, None)
    finally:
        start.SerialLine = before
        if key is not None:
            os.remove(KEY_FILE)


def test_only_a_whole_key_is_one():
    for size in (0, 1, 8, 31, 33, 64):
        link = started(bytes(size))
        assert link.signer is None, size
        (remark,) = link.logs
        assert remark[0] == 1 and b"32 bytes" in remark[1]
    link = started(bytes(range(32)))
    assert link.signer is not None and not link.logs


def test_without_a_key_it_says_so_once():
    link = started(None)
    assert link.signer is None
    (remark,) = link.logs
    assert b"no network.key" in remark[1]
