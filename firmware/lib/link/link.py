"""The robot's link to people: says what it does, hears what they want, over USB and, if there are credentials, over WiFi.

    link = start_link(config, settings, ...)       see start.py
    link.update(now_us, robot)        once a loop; never waits, at most one message a call
    link.frame(lidar)                 after each frame of the lidar
    link.state, link.af, link.ar, link.v    what is asked for: telemetry.STOPPED, AUTO, MANUAL; AF, AR (0.1 deg) and V count in MANUAL

robot has
    avoid, drive, odometry, lidar, health     as in docs/architecture.md
    took_us                          computing time that went into the latest decision
    off()                            before it restarts

One message is under way at a time. What is told again and again tells the latest when its turn comes, and what was passed over is counted in
`dropped`; what is told once waits. A long message is put together in one call, sealed in another in which nothing comes in, and sent in a third:
together that would take too long.
"""

import sys
from struct import pack_into
from time import ticks_diff

from micropython import const

from core.unload import forget
from link import messages
from link.commands import Commands

# What is told again and again, and how often; together within half of what the USB line carries, scans not counted
_HELLO = const(0)
_WHEELS = const(1)
_POINTS = const(2)
_HEALTH = const(3)
_CANDIDATES = const(4)
_ANSWER = const(5)
_POSE = const(6)
_KINDS = const(7)
_SEALED = const(-1)
_HELLO_US = const(1_000_000)
_WHEELS_US = const(50_000)
_POINTS_US = const(150_000)
_POINT_US = const(1500)  # more points come less often
_HEALTH_US = const(500_000)
_CANDIDATES_US = const(250_000)

_LOG = const(0x08)  # types of messages
_GREET = const(0x47)
_REPLY = const(0x0B)
_REPLY_SIZE = const(6)
_AT = const(8)  # place of the payload
_NONCE_AT = const(13)  # in a GREET: behind the counter and one byte more
_NONCE = const(8)
_SCANS_WANTED = const(1)  # flags of WATCH
_CANDIDATES_WANTED = const(2)
_TURNS_WANTED = const(4)

_DATAGRAMS = const(2)  # taken in a turn: checking a tag takes milliseconds
_FRAMES = const(9)  # of the cable, likewise
_STOP_BUTTON = const(1)  # of safety/faults.py
_WAITING = const(6)  # lines of the log kept until there is room
_QUIET_US = const(2_000_000)  # without a rare command: their module is let go
_RESTART_US = const(200_000)  # for the reply to get out


class Link(Commands):
    """See above.

    config: Config; session, safety, signer: see Commands; identity: the HELLO's JSON, bytes; encoder: Encoder;
    carriers: list of SerialLine and Datagrams.
    """

    def __init__(self, config, identity, encoder, carriers, session, safety, signer=None):
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

    def log(self, level, text):
        """Queue a line for the log: level 0 information, 1 warning, 2 error; text a str. Allocates; not for every loop."""
        if len(self.logs) < _WAITING:
            self.logs.append((level, text.encode()))
        else:
            self.dropped += 1

    def frame(self, lidar):
        """Take note of a lidar frame, for those who want raw scans."""
        scan = self._scan
        if scan is not None:
            if scan.ready:
                self.dropped += 1  # there was no room for it in time
            scan.add(lidar)

    def update(self, now_us, robot):
        """Hear commands, go on with a message. KeyboardInterrupt after a Ctrl-C on USB."""
        idle = True
        hears = False
        for line in self._carriers:
            line.update(now_us)
            idle = idle and line.idle()
            most = _DATAGRAMS if line.signed else _FRAMES
            while most and line.take(now_us):
                most -= 1
                genuine = self.obey(line, now_us, robot)
                if genuine:
                    line.heard(now_us)
                if line.signed and line.decoder.kind == _GREET and (genuine or self._is_due(_ANSWER, now_us, _HELLO_US)):
                    self._nonce = bytes(line.decoder.data[_NONCE_AT : _NONCE_AT + _NONCE])
                    if not genuine:
                        self._asker = line  # broadcasts do not reach everyone; once a second, so that nobody gains by asking
                if line.signed and not genuine:
                    line.shun(now_us)
                hears = hears or not line.signed  # strangers in the network must not be able to hold it up
            hears = hears or line.decoder.waiting()
        self.expire(now_us)
        self._remark(robot)
        if idle:
            if self._unsealed == _SEALED:
                self._unsealed = 0
                self._send()
            elif not self._unsealed:
                try:
                    self._tell(now_us, robot)
                except MemoryError:  # for the module that would tell it; the robot drives on
                    self._names_due = False
                    self.listing = -1
                    self.log(1, "no memory for this now: try again")
            elif not hears:
                self._encoder.seal(self._unsealed)
                self._unsealed = _SEALED
        if self._rare is not None and ticks_diff(now_us, self._rare_us) > _QUIET_US:
            self._let_go()
        if self.restarting and ticks_diff(now_us, self._rare_us) > _RESTART_US:
            try:
                self.rare(now_us, robot).restart(robot)
            except MemoryError:
                pass  # until there is

    def close(self):
        """Give the carriers back, Ctrl-C among them."""
        for line in self._carriers:
            line.close()

    def rare(self, now_us, robot, name="link.requests"):
        if self._rare != name:
            self._let_go()
            robot.drive.stop()  # loading takes tens of milliseconds, in which nobody looks ahead
            __import__(name)
            self._rare = name
            robot.feed()  # what follows has its whole second again
        self._rare_us = now_us
        return sys.modules[name]

    def _let_go(self):
        """One rare module at a time: what they take is counted by the largest."""
        if self._rare is not None:
            forget(self._rare)
            self._rare = None

    def watch(self, flags, robot):
        if flags & (_SCANS_WANTED | _CANDIDATES_WANTED):
            if self._watched is None:
                robot.drive.stop()
                from link import watched

                self._watched = watched
            if not flags & _SCANS_WANTED:
                self._scan = None
            elif self._scan is None:
                self._scan = self._watched.ScanGatherer(self._turn)
        elif self._watched is not None:
            self._watched = self._scan = None
            forget("link.watched")
        if flags & _TURNS_WANTED:
            if self._turns is None:
                robot.drive.stop()
                from link.turns import Turns

                self._turns = Turns(robot)
        elif self._turns is not None:
            self._turns.end(robot)
            self._turns = None
            forget("link.turns")
        self._wanted = flags

    def _remark(self, robot):
        """Put into the log what should not be missed."""
        fault = robot.drive.fault
        if fault is not self._drive_fault:
            self._drive_fault = fault
            if fault:
                self.log(2, fault)
        fault = self.safety.fault
        if fault != self._fault:
            self._fault = fault
            if fault == _STOP_BUTTON:
                self.stop()
                self.log(1, "stopped by its button; auto, driving by hand, or another press of a second lets it go on")
        health = robot.health
        if health.battery_low != self._battery_low:
            self._battery_low = health.battery_low
            if health.battery_low:
                self.log(1, "battery is low: it drives slowly; charge it soon")
        if health.lost != self._lost:
            self._lost = health.lost
            if health.lost:
                self.log(2, "the battery's voltage is not measured any more: check the wire of its divider")

    def _tell(self, now_us, robot):
        """Put the next message together, if there is one, and send it unless it is long."""
        data = self._encoder.data
        if self.greeted or self._is_due(_HELLO, now_us, _HELLO_US):
            self._hello(data, now_us)
        elif self._asker is not None:
            self._answer(data, now_us)
        else:
            length = self._once(data, now_us, robot) or self.again(data, now_us, robot)
            if length:
                self._encoder.seal(length)
                self._send()
            else:
                self._unsealed = self._long(data, now_us, robot)

    def _hello(self, data, now_us):
        self._told_us[_HELLO] = now_us
        self._names_due = self._names_due or self.greeted
        self.greeted = False
        self._seal_hello(data)
        self._send()
        for line in self._carriers:
            if line.signed:
                line.announce(self._encoder)

    def _answer(self, data, now_us):
        """Tell the session to one who greets without it."""
        self._told_us[_ANSWER] = now_us
        self._seal_hello(data)
        self._asker.answer(self._encoder)
        self._asker = None

    def _seal_hello(self, data):
        self._encoder.seal(messages.hello(data, self.session, self.counter, self._identity, self.signer, self._nonce))
        self._nonce = b""

    def _once(self, data, now_us, robot):
        """The next of the messages that are told once and must not be lost; the length of its payload, 0 when there is none."""
        if self.replies:
            counter, kind, status, text = self.replies.pop(0)
            pack_into("<IBB", data, _AT, counter, kind, status)
            return messages.text(_REPLY, data, _REPLY_SIZE, text)
        if self.logs:
            data[_AT], text = self.logs.pop(0)
            return messages.text(_LOG, data, 1, text)
        if self._names_due:
            self._names_due = False
            length = self.rare(now_us, robot, "link.reason_texts").names(data)
            self._let_go()
            return length
        if self.listing >= 0 and robot.avoid.decisions == self._decisions:
            length, total = self.rare(now_us, robot, "link.listing").parameter(data, self.config, self.listing)
            self.listing = self.listing + 1 if self.listing + 1 < total else -1
            return length
        return 0

    def again(self, data, now_us, robot):
        """The most urgent of the short messages that are told again and again; 0 when none is due."""
        avoid = robot.avoid
        decisions = avoid.decisions
        if decisions != self._decisions:
            if self._decisions >= 0:
                self.dropped += decisions - self._decisions - 1
            self._decisions = decisions
            return messages.decision(data, avoid, self.state, now_us, robot.took_us)
        if self._is_due(_WHEELS, now_us, _WHEELS_US):
            self._told_us[_WHEELS] = now_us
            return messages.wheels(data, robot.drive, now_us)
        if self._told_us[_POSE] != self._told_us[_WHEELS]:
            self._told_us[_POSE] = self._told_us[_WHEELS]
            return messages.pose(data, robot.odometry, now_us)
        if self._is_due(_HEALTH, now_us, _HEALTH_US):
            self._told_us[_HEALTH] = now_us
            return messages.health(data, robot, self.dropped, self.refused, len(self._carriers) > 1)
        if self._turns is not None and self._turns.due(now_us):
            return self._turns.take(data, now_us)
        goal = robot.goal
        return 0 if goal is None else goal.tell(data, now_us)

    def _long(self, data, now_us, robot):
        """The most urgent of the long messages; 0 when none is due."""
        avoid = robot.avoid
        if avoid.points_ordered and self._points_of != self._decisions and self._is_due(_POINTS, now_us, max(_POINTS_US, avoid.points_count * _POINT_US)):
            self._told_us[_POINTS] = now_us
            self._points_of = self._decisions
            return messages.points(data, avoid, now_us)
        if self._scan is not None and self._scan.ready:
            return self._scan.take(data)
        if self._wanted & _CANDIDATES_WANTED and self._is_due(_CANDIDATES, now_us, _CANDIDATES_US):
            self._told_us[_CANDIDATES] = now_us
            self._side = 1 - self._side
            return self._watched.candidates(data, avoid, self._side | (2 if avoid.v < 90 else 0), now_us)
        return 0

    def _send(self):
        for line in self._carriers:
            if not line.send(self._encoder):
                self.dropped += 1

    def _is_due(self, kind, now_us, period_us):
        last_us = self._told_us[kind]
        return last_us is None or not 0 <= ticks_diff(now_us, last_us) < period_us  # what was long ago may seem to come
