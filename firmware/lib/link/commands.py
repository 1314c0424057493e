"""What the person at the other end wants: drive by itself, by hand, or stand; and what they change."""

import struct
from time import ticks_diff

from micropython import const

from link.telemetry import AUTO, MANUAL, STOPPED

_HEADER = const(8)
_VERSION_AT = const(2)  # where what a tag covers begins
_TAG = const(8)  # auth.TAG; that module is loaded only where there is a key
_SILENCE_US = const(250_000)  # manual driving stops after this, so that the robot stands within 300 ms
_WAITING = const(6)  # replies kept until there is room

_DRIVE = const(0x41)
_WATCH = const(0x44)
_LIST = const(0x45)
_GREET = const(0x47)
_RESTART = const(0x48)
_ARM = const(0x50)
_LAST = const(0x51)

_OK = const(0)
_REFUSED = const(1)


class Commands:
    """Takes commands in and holds what they ask for. The Link adds rare(now_us, robot), the module requests.py, loaded, and watch(flags, robot).

    config: the Config that is tuned; session: the random bytes of this boot; signer: auth.Signer of the network key, or None, in which case no signed
    command is ever accepted. safety: Safety, which lets it drive, or not.

    state           STOPPED, AUTO or MANUAL; af, ar (0.1 deg), v (0..180) count in MANUAL
    greeted         True when HELLO and NAMES are wanted; listing: number of the next PARAMETER wanted, or -1. Whoever sends them resets these
    restarting      True when the robot is to restart
    changed         what has been tuned, see Settings
    counter         of the last signed command; refused: counts commands that were not obeyed
    replies         [(counter, type, status, text as bytes)] to the last commands, not sent yet
    """

    @property
    def state(self):
        return self.safety.state

    def expire(self, now_us):
        """Stop driving by hand when the hand is gone."""
        if self.state == MANUAL and ticks_diff(now_us, self._heard_us) > _SILENCE_US:
            self.stop()

    def stop(self):
        """Stand until told otherwise, as after the command to stop."""
        self.safety.stop()
        self.v = 90

    def drive_itself(self):
        """Drive on its own, as after the command. False while the stop button is pressed."""
        return self.safety.start(AUTO)

    def obey(self, line, now_us, robot):
        """Carry out the command that a carrier has just taken; True when it is one and genuine. Its reply waits then."""
        decoder = line.decoder
        kind, data, end = decoder.kind, decoder.data, decoder.end
        signed = line.signed
        if signed:
            end -= _TAG
        # What is cheap to see comes first: the tag takes milliseconds.
        if not _DRIVE <= kind <= _LAST or end < _HEADER + 4:
            self.refused += 1
            return False
        payload = memoryview(data)[_HEADER:end]
        counter = struct.unpack_from("<I", payload)[0]
        if signed:
            old = counter <= self.counter
            stop = kind == _DRIVE and len(payload) > 4 and payload[4] == STOPPED
            if old and not stop or not self._genuine(data, end):
                self.refused += 1
                return False
            if old:
                # Nothing moves by what is repeated. But a stop never harms.
                self.refused += 1
                self.stop()
                return False
            self.counter = counter
        status = _OK
        try:
            text = self._carry_out(line, kind, payload, now_us, robot)
        except ValueError as error:
            status, text = _REFUSED, str(error)
        except MemoryError:
            status, text = _REFUSED, "no memory for this now: try again"
        self.refused += status
        if len(self.replies) < _WAITING:
            self.replies.append((counter, kind, status, text.encode()[:200]))
        return True

    def _genuine(self, data, end):
        if self.signer is None:
            return False
        covered = memoryview(data)
        return self.signer.signed(self.session, covered[_VERSION_AT:end], covered[end : end + _TAG])

    def _carry_out(self, line, kind, payload, now_us, robot):
        """Returns the text of the reply."""
        if kind == _DRIVE:
            if len(payload) < 10 or not self._drive(line, now_us, *struct.unpack_from("<BhhB", payload, 4)):
                self.rare(now_us, robot).refuse_to_drive(payload)
        elif kind == _WATCH:
            self.watch(payload[4] if len(payload) > 4 else 0, robot)
        elif kind == _LIST:
            self.listing = 0
        elif kind != _GREET:
            driven = robot.drive.told_v256 != 0  # until the module is loaded
            rare = self.rare(now_us, robot, "arm.requests") if kind >= _ARM else self.rare(now_us, robot)
            return rare.carry_out(self, kind, payload, robot, driven)
        elif len(payload) > 4 and payload[4] & 1:
            self.greeted = True
        return ""

    def _drive(self, line, now_us, what, af, ar, v):
        """False if it cannot be."""
        if what == STOPPED:
            self.stop()
        elif what == AUTO:
            return self.drive_itself()
        elif what == MANUAL and -900 <= af <= 900 and -900 <= ar <= 900 and v <= 180:
            if self.state == MANUAL and self._hand is not line:
                return False  # one hand at a time: until it has let go
            silence = _SILENCE_US + 1 if self._heard_us is None else ticks_diff(now_us, self._heard_us)
            self._heard_us = now_us
            if self.state == STOPPED and 0 <= silence <= _SILENCE_US:  # one of minutes may look negative
                return False  # stopped by somebody else, or by its button, under a hand that has not noticed yet
            if self.state != what and not self.safety.start(what):
                return False
            self._hand = line
            self.af = af
            self.ar = ar
            self.v = v
        else:
            return False
        return True
