"""A recording in place of the world: gives the firmware what it got then, when it got it."""

from collections import deque
from dataclasses import dataclass, field

from host.recording import Decision, Inputs, Reader, RecordingError, Stream


@dataclass
class Log:
    """What a firmware gave out. decisions: [(time us, Decision)]. writes: [(time us, address, bytes)], the I2C writes in order."""

    decisions: list = field(default_factory=list)
    writes: list = field(default_factory=list)

    @property
    def end_us(self) -> int:
        """Time of the last thing given out; 0 if there is none."""
        return max((entry[0] for entry in (*self.decisions[-1:], *self.writes[-1:])), default=0)


class Tape:
    """The inputs of a recording, to be taken in their order; `then` is the Log of what came of them.

    Raises RecordingError if the recording cannot be replayed.
    """

    def __init__(self, reader: Reader):
        if reader.header.clock != "robot":
            raise RecordingError(
                f"{reader.path} was recorded over a link, without the lidar's bytes and the robot's clock: it can be looked at "
                "(python -m host.export, the monitor), but not replayed; the twin's recordings can"
            )
        self.then = Log()
        self._lidar: deque = deque()
        self._screen: deque = deque()
        self._commands: deque = deque()
        self._inputs: deque = deque()
        self._reads: dict = {}
        self._halts: deque = deque()
        last_read = 0
        for time, stream, data in reader:
            if reader.damage:
                break  # without what was lost the firmware would see something else from here on
            if stream in (Stream.COMMAND, Stream.INPUTS) and time != last_read:
                # it came when the firmware waited; what came while it read a chip needs no halt, the reading is one
                self._halts.append(time)
            if stream == Stream.LIDAR:
                self._lidar.append((time, data))
            elif stream == Stream.SCREEN:
                self._screen.append((time, data))
            elif stream == Stream.COMMAND:
                self._commands.append((time, data))
            elif stream == Stream.INPUTS:
                self._inputs.append((time, Inputs.unpack(data)))
            elif stream == Stream.READ:
                self._reads[time, data[0], len(data) - 1] = data[1:]
                last_read = time
            elif stream == Stream.DECISION:
                self.then.decisions.append((time, Decision.unpack(data)))
            elif stream == Stream.REGISTERS:
                self.then.writes.append((time, data[0], data[1:]))
        self.cut = reader.damage[0] if reader.damage else reader.cut
        self.inputs = self._inputs[0][1] if self._inputs else Inputs(0, 0, ())
        if not self.then.writes:
            raise RecordingError(f"{reader.path} holds nothing to compare: the firmware gave nothing out before it ends")

    def take_lidar(self, time: int, most: int, room: int) -> list[tuple[int, bytes]]:
        """Up to `most` pieces of at most `room` bytes together of which a byte has arrived by the time: [(time of it, bytes)]."""
        return _taken(self._lidar, time, most, room)

    def take_screen(self, time: int, most: int, room: int) -> list[tuple[int, bytes]]:
        """The same of the screen."""
        return _taken(self._screen, time, most, room)

    def take_commands(self, time: int) -> list[bytes]:
        """What was sent to the robot's link by the time."""
        out = []
        while self._commands and self._commands[0][0] <= time:
            out.append(self._commands.popleft()[1])
        return out

    def turn_inputs(self, time: int) -> Inputs:
        """What the inputs showed at the time."""
        while self._inputs and self._inputs[0][0] <= time:
            self.inputs = self._inputs.popleft()[1]
        return self.inputs

    def read(self, time: int, address: int, size: int) -> bytes | None:
        """What a chip answered when it was read then; None if it was not read at that moment."""
        return self._reads.get((time, address, size))

    def next_us(self, time: int) -> int | None:
        """The next moment at which the firmware must hear of something, seen from `time`; None when there is none any more.

        It is as in the recorded run, because at this moment the simulated board hands over all lidar bytes that are on the line.
        """
        while self._halts and self._halts[0] <= time:
            self._halts.popleft()
        ahead = [self._halts[0]] if self._halts else []
        ahead += [line[0][0] for line in (self._lidar, self._screen) if line]
        return min(ahead, default=None)


def _taken(line: deque, time: int, most: int, room: int) -> list[tuple[int, bytes]]:
    out: list[tuple[int, bytes]] = []
    while line and line[0][0] <= time and len(out) < most and len(line[0][1]) <= room:
        out.append(line.popleft())
        room -= len(out[-1][1])
    return out
