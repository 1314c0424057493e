"""The robot's link to people: says what it does, hears what they want, over USB and, if there are credentials, over WiFi.

    link = link_start.start_link(config, settings, names, machine)       or Link(...), with the carriers handed in
    link.update(now_us, robot)        once a loop; never waits, at most one message a call and carrier
    link.frame(lidar)                 after each frame of the lidar
    link.state, link.af, link.ar, link.v    what is asked for: telemetry.STOPPED, AUTO, MANUAL; AF, AR (0.1 deg) and V count in MANUAL

robot has
    avoid, drive, odometry, lidar, health     as in docs/architecture.md
    took_us                          computing time that went into the latest decision

What is told again and again is dropped, and counted, when a carrier is too slow for it; what is told once waits for room.
"""

from time import ticks_diff

from micropython import const

from link import telemetry
from link.commands import Commands
from link.messages import Messages, ScanGatherer, parameters
from link.telemetry import Encoder
from safety.health import STOP_BUTTON

# How often each message goes out. Together they keep within half of what the USB line carries, scans not counted.
_WHEELS_US = const(50_000)
_POINTS_US = const(150_000)
_POINT_US = const(1500)  # more points come less often
_HEALTH_US = const(500_000)
_CANDIDATES_US = const(250_000)
_HELLO_US = const(1_000_000)
_NAMES_HELLOS = const(8)
_LONG_US = const(1_000_000)  # a press of the stop button that lets a standing robot drive
_WAITING = const(6)  # replies and lines of the log kept until there is room


class Link:
    """See above.

    settings: Settings; identity, names: see Messages; carriers: list of SerialLine and Datagrams; session, key: see Commands.
    """

    def __init__(self, config, settings, identity, names, carriers, session, key=None):
        self._carriers = carriers
        self._session = session
        self._commands = Commands(session, key)
        self.radio = any(carrier.signed for carrier in carriers)
        self._encoder = Encoder(datagrams=self.radio)
        self._report = Messages(self._encoder, identity, names)
        self._scan = ScanGatherer(config.lidar_frames)
        self._settings = settings
        self._config = config
        self.dropped = 0
        self._decisions = -1
        self._wheels_us = self._points_us = self._health_us = self._hello_us = self._answered_us = self._candidates_us = None
        self._side = 0
        self._pose_next = False
        self._points_of = -1
        self._hellos = 0
        self._names_due = True
        self._replies = []
        self._drive_fault = ""
        self._pressed_us = None  # since when the stop button is held
        self._stood = False  # before it was
        self._battery_low = False
        self._logs = []

    @property
    def state(self):
        return self._commands.state

    @property
    def manual(self):
        """True while the robot is driven by hand."""
        return self._commands.state == telemetry.MANUAL

    @property
    def af(self):
        return self._commands.af

    @property
    def ar(self):
        return self._commands.ar

    @property
    def v(self):
        return self._commands.v

    def stop(self):
        """Stand until told otherwise, as after the command to stop."""
        self._commands.stop()

    def drive_itself(self):
        """Drive on its own, as after the command."""
        self._commands.state = telemetry.AUTO

    def log(self, level, text):
        """Queue a line for the log: level 0 information, 1 warning, 2 error; text a str. Allocates; not for every loop."""
        if len(self._logs) < _WAITING:
            self._logs.append((level, text.encode()))
        else:
            self.dropped += 1

    def frame(self, lidar):
        """Take note of a lidar frame, for those who want raw scans."""
        if self._commands.watch & 1:
            if self._scan.ready:
                self.dropped += 1  # there was no room for it in time
            self._scan.add(lidar)

    def update(self, now_us, robot):
        """Hear commands, send one message. KeyboardInterrupt after a Ctrl-C on USB."""
        commands = self._commands
        listened = False
        for carrier in self._carriers:
            carrier.update(now_us)
            listened = listened or carrier.busy
            while carrier.take(now_us):
                if commands.obey(carrier.decoder, carrier.signed, now_us, self._settings):
                    carrier.heard(now_us)
                    if len(self._replies) < _WAITING:
                        self._replies.append(commands.reply)
                elif carrier.decoder.kind == telemetry.GREET and carrier.signed:
                    self._answer(carrier, now_us)
        commands.expire(now_us)
        if robot.health is not None:
            self._button(now_us, robot.health.fault == STOP_BUTTON)
        self._remark(robot)
        if self._due(now_us, self._hello_us, _HELLO_US) or commands.greeted:
            self._hello(now_us)
        elif listened:
            size = 0
            waits = self._replies or self._logs or self._names_due or commands.listing >= 0
            room = self._has_room()
            if waits and room:
                size = self._once()
            if not size:
                size = self._again(now_us, robot)
            if not size and room and not waits:  # these would leave no room for what waits
                size = self._bulky(now_us, robot)
            if size:
                self._send(size, now_us)

    def _answer(self, carrier, now_us):
        """Tell the session to one who greets without it: broadcasts do not reach everyone. Once a second, so that nobody gains by asking."""
        if self._due(now_us, self._answered_us, _HELLO_US):
            self._answered_us = now_us
            carrier.answer(self._encoder, self._report.hello(self._session, self._commands.counter))

    def close(self):
        """Give the carriers back, Ctrl-C among them."""
        for carrier in self._carriers:
            carrier.close()

    def _remark(self, robot):
        """Put into the log what should not be missed."""
        fault = robot.drive.fault
        if fault is not self._drive_fault:
            self._drive_fault = fault
            if fault:
                self.log(2, fault)
        low = robot.health is not None and robot.health.battery_low
        if low != self._battery_low:
            self._battery_low = low
            if low:
                self.log(1, "battery is low: charge it soon")

    def _button(self, now_us, pressed):
        """The stop button is a command to stop, and like one it counts until there is another. Pressed long, it lets a standing robot drive."""
        commands = self._commands
        if pressed:
            if self._pressed_us is None:
                self._pressed_us = now_us
                self._stood = commands.state == telemetry.STOPPED
                self.log(1, "stopped by its button; auto, driving by hand, or another press of a second lets it go on")
            commands.stop()
        elif self._pressed_us is not None:
            if self._stood and ticks_diff(now_us, self._pressed_us) >= _LONG_US:
                self.drive_itself()
            self._pressed_us = None

    def _has_room(self):
        """Whether every carrier takes any message now."""
        for carrier in self._carriers:
            if carrier.room() < telemetry.MAX_FRAME:
                return False
        return True

    def _once(self):
        """Compose the next of the messages that are told once and must not be lost; 0 when there is none."""
        report, commands = self._report, self._commands
        if self._replies:
            return report.reply(*self._replies.pop(0))
        if self._logs:
            level, text = self._logs.pop(0)
            return report.log(level, text)
        if self._names_due:
            self._names_due = False
            return report.names()
        if commands.listing >= 0:
            number = commands.listing
            commands.listing = number + 1 if number + 1 < parameters(self._config) else -1
            return report.parameter(self._config, number)
        return 0

    def _again(self, now_us, robot):
        """Compose the most urgent of the short messages that are told again and again; 0 when none is due."""
        report = self._report
        avoid = robot.avoid
        if avoid.decisions != self._decisions:
            self._decisions = avoid.decisions
            return report.decision(avoid, self._commands.state, now_us, robot.took_us)
        if self._due(now_us, self._wheels_us, _WHEELS_US):
            self._wheels_us = now_us
            self._pose_next = True
            return report.wheels(robot.drive, now_us)
        if self._pose_next:
            self._pose_next = False
            return report.pose(robot.odometry, now_us)
        if robot.health is not None and self._due(now_us, self._health_us, _HEALTH_US):
            self._health_us = now_us
            return report.health(robot.health, robot.lidar, self.dropped, self._commands.refused, self.radio)
        return 0

    def _bulky(self, now_us, robot):
        """Compose the most urgent of the long messages; 0 when none is due."""
        report, commands = self._report, self._commands
        avoid = robot.avoid
        if (
            avoid.points_count >= 0
            and self._points_of != self._decisions
            and self._due(now_us, self._points_us, max(_POINTS_US, avoid.points_count * _POINT_US))
        ):
            self._points_us = now_us
            self._points_of = self._decisions
            return report.points(avoid, now_us)
        if self._scan.ready:
            return self._scan.take(self._encoder)
        if commands.watch & 2 and self._due(now_us, self._candidates_us, _CANDIDATES_US):
            self._candidates_us = now_us
            self._side = 1 - self._side
            return report.candidates(avoid, self._side | (2 if avoid.v < 90 else 0), now_us)
        return 0

    def _hello(self, now_us):
        self._hello_us = now_us
        self._hellos += 1
        if self._commands.greeted or self._hellos % _NAMES_HELLOS == 0:
            self._names_due = True
        self._commands.greeted = False
        size = self._report.hello(self._session, self._commands.counter)
        for carrier in self._carriers:
            if carrier.signed:
                carrier.announce(self._encoder, size)
            self._send_to(carrier, size, now_us)

    def _send(self, size, now_us):
        for carrier in self._carriers:
            self._send_to(carrier, size, now_us)

    def _send_to(self, carrier, size, now_us):
        if not carrier.send(self._encoder, size, now_us):
            self.dropped += 1

    def _due(self, now_us, last_us, period_us):
        return last_us is None or ticks_diff(now_us, last_us) >= period_us
