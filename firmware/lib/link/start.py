"""Puts the robot's link together. Needed once, at the start: then it is unloaded."""

import json
import os

from micropython import const

from core.version import VERSION
from link.link import Link
from link.serial_line import SerialLine
from link.telemetry import Encoder

_KEY = const(32)  # bytes; what is shorter, or empty, could be guessed
_SESSION = const(8)  # auth.SESSION; that module is loaded only where there is a key


def start_link(config, machine, safety, wlan=None, remark=None):
    """Link over USB and, if robot.json names a network, over WiFi. Without it the radio is never touched.

    machine: the module; safety: Safety; wlan, remark: of link.wifi.connect(). Commands over WiFi need the file network.key; without it they are all refused.
    """
    encoder = Encoder()
    carriers = [SerialLine()]
    remarks = [remark] if remark else []
    signer = None
    if wlan is not None:
        import socket

        from link.radio import Datagrams

        carriers.append(Datagrams(wlan, socket, config.wifi_port, encoder))
    if config.wifi_ssid:
        try:
            with open("network.key", "rb") as file:
                key = file.read(_KEY + 1)
            if len(key) == _KEY:
                from link.auth import Signer

                signer = Signer(key)
            else:
                remarks.append("network.key is not of 32 bytes: commands over WiFi are refused; make deploy puts a new one on the board")
        except OSError:
            remarks.append("no network.key: commands over WiFi are refused; make deploy puts one on the board")
    identity = json.dumps(_identity(config, machine)).encode()
    link = Link(config, identity, encoder, carriers, os.urandom(_SESSION), safety, signer)
    for remark in remarks:
        link.log(1, remark)
    return link


def _identity(config, machine):
    """The HELLO's JSON as a dict."""
    board = machine.unique_id().hex()
    return {
        "firmware": VERSION,
        "robot": "gapseeker-" + board[-4:],
        "board": board,
        "boot": {1: "power", 2: "reset", 3: "watchdog", 4: "sleep", 5: "restart"}.get(machine.reset_cause(), "unknown"),
        "width": config.robot_width,
        "length": config.robot_length,
        "track": config.axles_track,
        "spacings": list(config.axles_spacings),
        "first": config.axles_first,
        "full_speed": config.motors_full_speed,
        "lidar": [config.lidar_x, config.lidar_y],
    }
