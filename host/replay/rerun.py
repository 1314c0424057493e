"""The firmware's own code against a tape, in lockstep, with the twin's simulated board."""

import json
import math
from dataclasses import dataclass

from host.recording import Decision
from host.twin import image, load_config, process, wire
from host.twin.pca9685 import Pca9685
from host.twin.vehicle import Vehicle

from .tape import Log, Tape

ROOM = wire.REPLY - wire.PAYLOAD


@dataclass
class Rerun:
    """log: what the firmware gave out now. stopped: why it ended before the tape did, else empty."""

    log: Log
    stopped: str = ""


def settings(robot: str, changes: dict) -> str:
    """The recorded robot.json with {"section.key": value} put over it, as text. ValueError names a change that cannot be."""
    if not changes:
        return robot
    changed = load_config(json.loads(robot), changes=changes)
    Vehicle.from_settings(changed)
    return json.dumps(changed)


def rerun(tape: Tape, robot: str, engine: str = process.ENGINES[0], firmware=image.FIRMWARE, chip: float = math.inf, files: dict | None = None) -> Rerun:
    """Run the firmware on the tape for as long as it gave anything out then.

    robot: text of robot.json. engine: see `process.ENGINES`. chip, files: see `process.Process`; as it was then, or nothing agrees.
    """
    vehicle = Vehicle.from_settings(json.loads(robot))
    board = _Board(tape, vehicle)
    child = process.Process(engine, robot, lambda data: None, firmware, chip=chip, files=files)
    try:
        while (answer := board.serve(request := child.receive(), child.send_serial)) is not None:
            if request.kind == wire.RESET:
                child.restart()
            else:
                child.answer(*answer)
    except process.FirmwareStopped as stopped:
        return Rerun(board.log, str(stopped))
    finally:
        child.close()
    return Rerun(board.log)


class _Board:
    """The electronics round the processor, as far as the firmware can tell: chips that hold what was written, and the tape."""

    def __init__(self, tape: Tape, vehicle: Vehicle):
        self.log = Log()
        self._tape = tape
        self._wire = vehicle.lidar.rx, vehicle.lidar.baud
        self._screen = vehicle.screen
        self._end = tape.then.end_us
        self._chips: dict[int, Pca9685] = {}

    def serve(self, request: wire.Request, send_serial):
        """Answer to one request of the firmware (see `process.Process.answer`); None when the tape is over."""
        self._note(request)
        if request.target > self._end:
            return None
        inputs = self._tape.turn_inputs(request.target)
        shown = inputs.levels, inputs.addresses, inputs.battery
        for data in self._tape.take_commands(request.target):
            send_serial(data)
        if request.kind == wire.READ:
            answered = self._tape.read(request.now, request.address, request.size)
            computed = self._chip(request.address).read(request.size)
            return 0, *shown, (), computed if answered is None else answered
        if request.kind != wire.ADVANCE:
            return 0, *shown
        pieces = [(time, data, *self._wire) for time, data in self._tape.take_lidar(request.target, wire.CHUNKS, ROOM)]
        if self._screen is not None and self._screen.rx is not None:
            room = ROOM - sum(len(piece[1]) for piece in pieces)
            said = self._tape.take_screen(request.target, wire.CHUNKS - len(pieces), room)
            pieces += [(time, data, self._screen.rx, self._screen.baud) for time, data in said]
        horizon = self._tape.next_us(request.target)
        return self._end + 1 if horizon is None else horizon, *shown, pieces

    def _note(self, request: wire.Request) -> None:
        decisions = self.log.decisions
        if request.probe[0] and (not decisions or decisions[-1][1].number != request.probe[0]):
            decisions.append((request.now, Decision(*request.probe)))
        for time, kind, address, _, data in request.events:
            if kind == wire.I2C_WRITE:
                self._chip(address).write(data)
                self.log.writes.append((time, address, data))

    def _chip(self, address: int) -> Pca9685:
        return self._chips.setdefault(address, Pca9685())
