"""Puts the robot's link together, and does what the constructors of its parts do. Needed once, at the start: then it is unloaded."""

import json
import os
import select

from micropython import const

from core.version import VERSION
from link.link import Link
from link.serial_line import SerialLine
from link.telemetry import Decoder, Encoder

_COMMAND = const(200)  # longest payload of a command
_KINDS = const(7)  # of what link.py tells again and again
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


def set_up_link(self, config, identity, encoder, carriers, session, safety, signer):
    """Fields of a Link, and of the Commands in it."""
    self.config = config
    self.changed = {}
    self.session = session
    self.signer = signer
    self.safety = safety
    self.af = self.ar = self.refused = self.counter = 0
    self.v = 90
    self.greeted = self.restarting = False
    self.listing = -1
    self.replies = []
    self._heard_us = None
    self._identity = identity
    self._encoder = encoder
    self._carriers = carriers
    self.dropped = 0
    self._told_us = [None] * _KINDS  # when each was told last
    self._decisions = self._points_of = -1
    self._unsealed = 0  # payload's length of the long message that has been put together; _SEALED when it has its check and has yet to be sent
    self._names_due = False
    self._nonce = b""  # of a greeting over the network, for the HELLO that answers it
    self._asker = None  # the carrier over which somebody asked without knowing the session
    self._logs = []
    self._drive_fault = ""
    self._battery_low = False
    self._fault = 0  # told last
    self._lost = False
    self._turn = config.lidar_frames  # of the lidar; told at the start only
    self._watched = self._scan = None  # the module, while wanted; its ScanGatherer
    self._wanted = self._side = 0
    self._rare = None  # the module requests.py
    self._rare_us = 0


def set_up_line(self, source, sink, clock):
    """Fields of a SerialLine."""
    # CPython's buffered reader would take bytes that select then no longer sees.
    self._source = getattr(source.buffer, "raw", source.buffer)
    self._sink = sink.buffer
    self._clock = clock
    poller = select.poll()
    poller.register(source, select.POLLIN)
    self._ready = getattr(poller, "ipoll", poller.poll)  # poll makes a list at each call
    self._one = bytearray(1)
    self.decoder = Decoder(_COMMAND)
    self._begun_us = 0  # when the frame that is coming in began
    self._data = None  # of the frame that goes out
    self._at = self._end = 0  # what of it has yet to go
    self._empty_us = clock()  # when the FIFO will be empty
