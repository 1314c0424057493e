"""What the person at the other end wants: drive by itself, by hand, or stand; and what they change."""

import json
import struct
from time import ticks_diff

from micropython import const

from link import telemetry

_TAG = const(8)  # auth.TAG; that module is loaded only where there is a key
_SILENCE_US = const(250_000)  # manual driving stops after this, so that the robot stands within 300 ms
_FIRST = telemetry.DRIVE
_LAST = telemetry.GREET


class Commands:
    """Takes commands in and holds what they ask for.

    session: the random bytes of this boot; key: the network key, or None, in which case no signed command is ever accepted.

    state           STOPPED, AUTO or MANUAL; af, ar (0.1 deg), v (0..180) count in MANUAL
    watch           bit 0: scans wanted, bit 1: candidates wanted
    greeted         True when HELLO and NAMES are wanted; listing: number of the next PARAMETER wanted, or -1. The sender resets them
    refused         counter of commands that were not obeyed
    reply           (counter, type, status, text) of the last command, text as bytes
    """

    def __init__(self, session, key=None, state=telemetry.AUTO):
        self._session = session
        self._key = key
        self.state = state
        self.af = 0
        self.ar = 0
        self.v = 90
        self.watch = 0
        self.greeted = False
        self.listing = -1
        self.refused = 0
        self.counter = 0
        self.reply = None
        self._heard_us = None

    def expire(self, now_us):
        """Stop driving by hand when the hand is gone."""
        if self.state == telemetry.MANUAL and ticks_diff(now_us, self._heard_us) > _SILENCE_US:
            self.stop()

    def stop(self):
        """Stand until told otherwise."""
        self.state = telemetry.STOPPED
        self.v = 90

    def obey(self, decoder, signed, now_us, settings):
        """Carry out the command the decoder has just taken; True when it is one and genuine (a reply is due then).

        signed: it must carry a tag. settings: a Settings.
        """
        kind, start, end = decoder.kind, decoder.start, decoder.end
        if signed:
            end -= _TAG
        if not _FIRST <= kind <= _LAST or end - start < 4:
            self.refused += 1
            return False
        data = decoder.data
        if signed and not self._genuine(data, start - telemetry.HEADER + 2, end):
            self.refused += 1
            return False
        payload = memoryview(data)[start:end]
        counter = struct.unpack_from(telemetry.COUNTER_FORMAT, payload)[0]
        if signed and counter <= self.counter:
            # Old or repeated: nothing moves. But a stop never harms.
            self.refused += 1
            if kind == telemetry.DRIVE and len(payload) > 4 and payload[4] == telemetry.STOPPED:
                self.stop()
            return False
        if signed:
            self.counter = counter
        try:
            self._carry_out(kind, payload, now_us, settings)
            self.reply = (counter, kind, telemetry.OK, b"")
        except ValueError as error:
            self.refused += 1
            self.reply = (counter, kind, telemetry.REFUSED, str(error).encode()[:200])
        except MemoryError:
            self.refused += 1
            self.reply = (counter, kind, telemetry.REFUSED, b"no memory for this now: try again")
        return True

    def _genuine(self, data, start, end):
        if self._key is None:
            return False
        from link.auth import same, tag

        return same(tag(self._key, self._session, memoryview(data)[start:end]), memoryview(data)[end : end + _TAG])

    def _carry_out(self, kind, payload, now_us, settings):
        if kind == telemetry.DRIVE:
            self._drive(payload, now_us)
        elif kind == telemetry.TUNE:
            key, equals, value = bytes(payload[4:]).decode().partition("=")
            if not equals:
                raise ValueError("write key=value")
            try:
                value = json.loads(value)
            except ValueError:
                raise ValueError("%s: %s is no value as in JSON" % (key, value)) from None
            settings.tune(key.strip(), value)
        elif kind == telemetry.KEEP:
            settings.keep()
        elif kind == telemetry.WATCH:
            self.watch = _fields(telemetry.WATCH_FORMAT, payload)[1]
        elif kind == telemetry.LIST:
            self.listing = 0
        elif kind == telemetry.POINT:
            _, wheel, angle = _fields(telemetry.POINT_FORMAT, payload)
            self.stop()
            settings.point(wheel, angle)
        elif len(payload) > 4 and payload[4] & 1:
            self.greeted = True

    def _drive(self, payload, now_us):
        _, what, af, ar, v = _fields(telemetry.DRIVE_FORMAT, payload)
        if what == telemetry.STOPPED:
            self.stop()
        elif what == telemetry.AUTO:
            self.state = what
        elif what == telemetry.MANUAL:
            if not (-900 <= af <= 900 and -900 <= ar <= 900 and v <= 180):
                raise ValueError("AF %d, AR %d (0.1 deg, up to 900 either way), V %d (0 to 180)" % (af, ar, v))
            silence = _SILENCE_US + 1 if self._heard_us is None else ticks_diff(now_us, self._heard_us)
            self._heard_us = now_us
            if self.state == telemetry.STOPPED and silence <= _SILENCE_US:
                # Stopped by somebody else, or by its button, under a hand that has not noticed yet.
                raise ValueError("stopped: let go for a moment, then drive on")
            self.state = what
            self.af = af
            self.ar = ar
            self.v = v
        else:
            raise ValueError("drive %d: 0 stop, 1 auto, 2 manual" % what)


def _fields(form, payload):
    if len(payload) < struct.calcsize(form):
        raise ValueError("%d bytes are too few" % len(payload))
    return struct.unpack_from(form, payload)
