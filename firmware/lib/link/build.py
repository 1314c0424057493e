"""What the constructors of the link and of its serial line do. Needed once, at the start: then it is unloaded, and its memory is the robot's."""

import select

from micropython import const

from link.telemetry import Decoder

_COMMAND = const(200)  # longest payload of a command
_KINDS = const(7)  # of what link.py tells again and again


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
    self._heard_us = self._hand = None
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
    self.logs = []
    self._drive_fault = ""
    self._battery_low = False
    self._fault = 0  # told last
    self._lost = False
    self._turn = config.lidar_frames  # of the lidar; told at the start only
    self._watched = self._scan = self._turns = None  # the module, while wanted; its ScanGatherer; a Turns
    self._wanted = self._side = 0
    self._rare = None  # name of the module that is loaded for a rare command
    self._rare_us = 0


def set_up_line(self, source, sink, clock):
    """Fields of a SerialLine."""
    # CPython's buffered reader would take bytes that select then no longer sees.
    self.source = getattr(source.buffer, "raw", source.buffer)
    self._sink = sink.buffer
    self._clock = clock
    poller = select.poll()
    poller.register(source, select.POLLIN)
    self.ready = getattr(poller, "ipoll", poller.poll)  # poll makes a list at each call
    self._one = bytearray(1)
    self.decoder = Decoder(_COMMAND)
    self._begun_us = 0  # when the frame that is coming in began
    self._data = None  # of the frame that goes out
    self._at = self._end = 0  # what of it has yet to go
    self._empty_us = clock()  # when the FIFO will be empty
