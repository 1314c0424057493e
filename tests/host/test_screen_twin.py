"""The screen at its bytes, under the whole firmware: what a person sees, touches, and screens that are slow, silent, unplugged or send rubbish."""

import json

import numpy as np
import pytest

from host.link import messages
from host.twin import Observer, run
from host.twin.cli import main
from host.twin.screen import KINDS, Screen
from link import frames

CELL, MM = 5, 46  # pixels and mm of a cell, for a body 600 mm long
BUTTONS = {1: (40, 270), 2: (120, 270), 3: (200, 270), 4: (40, 305), 5: (120, 305), 6: (200, 305)}
STOP, START, SET = 1, 2, 3
LESS, KEEP, NEXT, MORE, BACK = 2, 3, 4, 5, 6
READY_S = 5.0  # power to the first decision, and all of it drawn
WHITE = 255 * 3
MOST_MS = 12.0  # the longest turn of the loop that the robot tells of; it has loaded nothing


class Person(Observer):
    """Does things at their times, and keeps what the robot tells. todo: [(s, function of the simulation)]."""

    def __init__(self, *todo):
        self._todo = sorted(todo, key=lambda pair: pair[0])
        self._frames = frames.FrameReader()
        self.told = []
        self.simulation = self.folder = None

    def board(self, folder):
        self.folder = folder

    def serial(self, data):
        self.told += [message for kind, _, payload in self._frames.read(data) if (message := messages.decode(kind, payload))]

    def step(self, simulation):
        self.simulation = simulation
        while self._todo and simulation.now >= self._todo[0][0] * 1e6:
            self._todo.pop(0)[1](simulation)

    def of(self, kind):
        return [message for message in self.told if message["type"] == kind]


def touch(button):
    return lambda simulation: simulation.screen.touch(simulation.now, *BUTTONS[button])


def touches(*buttons, start=READY_S, every=0.4):
    return [(start + every * k, touch(button)) for k, button in enumerate(buttons)]


def drive(person, kind="usart-gpu", limit_s=9.0, waits=True, **more):
    changes = {"screen.kind": kind, "drive.autostart": not waits, **more.pop("changes", {})}
    return run("Z", width=550, watch=person, limit_s=limit_s, changes=changes, record=False, **more)


def bright(simulation, x, y):
    return sum(simulation.screen.glass.image.getpixel((x, y)))


def colours(simulation, x, y, wide, high):
    """The colours in a part of the glass."""
    part = np.array(simulation.screen.glass.image.crop((x, y, x + wide, y + high))).reshape(-1, 3)
    return {tuple(map(int, colour)) for colour in part}


def cell(x, y):
    """Middle of the cell of a place in the body frame, pixels."""
    return (x + 24 * MM) // MM * CELL + 2, (21 * MM - y) // MM * CELL + 2


@pytest.mark.parametrize("kind", KINDS)
def test_a_robot_between_two_walls_is_shown_as_it_stands(kind):
    """At the start of the Z: walls 275 mm to its left and right, one 650 behind it; nothing between them and the body."""
    person = Person()
    drive(person, kind, limit_s=READY_S + 1)
    simulation = person.simulation
    screen = simulation.screen
    assert not screen.refused and not screen.lost and screen.done > 30
    for y in (-400, -100, 100, 200):
        for x in (-275, 275):
            near = [bright(simulation, *cell(x + off, y)) for off in (-30, 0, 30)]
            assert max(near) > 200, (x, y)
        for x in (-200, 200, 0):
            assert bright(simulation, *cell(x, y)) == 0, (x, y)
    assert bright(simulation, *cell(-120, 0)) == bright(simulation, *cell(120, 250)) == bright(simulation, *cell(0, 290)) == WHITE
    lines = [colours(simulation, 0, 182 + 18 * line, 240, 18) for line in range(4)]
    assert all(len(line) > 2 for line in lines)  # letters, with their edges
    buttons = [bright(simulation, *BUTTONS[button]) > 0 for button in (1, 2, 3)]
    assert all(buttons) == (kind != "uart-lcd")


def test_the_picture_follows_the_robot_and_never_fills_the_screen_s_buffer():
    """Several pictures a second: while it turns into the passage, the cells change with it."""
    changes = []
    person = Person(*[(6 + 0.25 * k, lambda simulation: changes.append(np.array(simulation.screen.glass.image)[:180])) for k in range(24)])
    drive(person, limit_s=12.5, waits=False)
    screen = person.simulation.screen
    assert not screen.refused and not screen.lost
    different = [bool((one != other).any()) for one, other in zip(changes, changes[1:])]
    assert sum(different) >= 20


@pytest.mark.parametrize("kind", ("usart-gpu", "nextion"))
def test_touches_start_and_stop_it(kind):
    person = Person((READY_S, touch(START)), (READY_S + 2, touch(STOP)))
    drive(person, kind, limit_s=READY_S + 3)
    states = [message["state"] for message in person.of("decision")]
    order = [state for state, before in zip(states, [None, *states]) if state != before]
    assert order[-3:] == ["waiting", "auto", "stopped"]
    assert any(message["v"] > 90 for message in person.of("decision"))
    assert not person.simulation.electronics.motors_on


def test_setting_by_touch_is_kept_on_the_board():
    """Mode, cruise, a trim and the network; then back, and the three buttons are there again."""
    order = [SET, MORE, NEXT, MORE, MORE, *[NEXT] * 4, LESS, *[NEXT] * 10, MORE, KEEP]
    looks = []
    person = Person(
        *touches(*order, every=0.3),
        (READY_S + 0.3 * len(order) + 1.0, lambda simulation: looks.append(json.loads((person.folder / "robot.json").read_text()))),
        (READY_S + 0.3 * len(order) + 1.2, touch(BACK)),
    )
    drive(person, limit_s=READY_S + 0.3 * len(order) + 2.5)
    (kept,) = looks
    assert kept["mode"] == "NAWS"
    assert kept["drive"]["cruise"] == 110
    assert kept["servos"]["trims"][0] == -0.5 and not any(kept["servos"]["trims"][1:])
    assert kept["wifi"]["ssid"] == "gapseeker" and kept["wifi"]["access_point"] is True
    assert not person.simulation.screen.refused
    assert bright(person.simulation, 4, 260) > 200  # the corner of STOP, where setting has nothing
    assert not [message for message in person.of("decision") if message["v"] != 90]


def test_set_while_it_drives_stops_it_first():
    person = Person((READY_S, touch(START)), (READY_S + 2, touch(SET)), (READY_S + 2.05, touch(SET)))
    drive(person, limit_s=READY_S + 3.2)
    assert person.of("decision")[-1]["state"] == "stopped"
    assert bright(person.simulation, 4, 260) > 200  # nothing is loaded while it rolls


def test_a_start_from_elsewhere_ends_setting():
    from link import protocol

    class Both(Person):
        def commands(self):
            due = self.simulation is not None and self.simulation.now > 7e6 and not self.sent
            self.sent = self.sent or due
            return frames.frame(protocol.DRIVE, messages.drive(1, "auto")) if due else b""

    looks = []
    person = Both(*touches(SET), (6.8, lambda simulation: looks.append(bright(simulation, 4, 260))))
    person.sent = False
    drive(person, limit_s=9)
    assert looks == [0] and bright(person.simulation, 4, 260) > 200


def worst(person):
    return max(message["worst"] for message in person.of("health") if message["uptime"] > READY_S)


def test_no_screen_delays_the_loop():
    """Slow, silent, unplugged, or talking rubbish all the time: the robot goes on as with a good one, and what a good one shows comes back."""

    def babble(simulation):
        simulation.screen.send(simulation.now, bytes(range(256)))

    cases = {
        "good": (),
        "slow": ((0, lambda simulation: setattr(simulation.screen, "factor", 300.0)),),
        "silent": ((0, lambda simulation: setattr(simulation.screen, "silent", True)),),
        "rubbish": ((0, lambda simulation: setattr(simulation.screen, "rubbish", b"[BN:[BN:99]\xff\x00OOK[[")), *((4 + 0.03 * k, babble) for k in range(100))),
        "unplugged": ((0, lambda simulation: simulation.screen.plug(False)),),
    }
    for name, todo in cases.items():
        person = Person(*todo)
        result = drive(person, limit_s=7.5, waits=False)
        assert person.simulation.body.y > 100, name  # it has driven
        assert result.contacts == 0, name
        assert worst(person) < MOST_MS, (name, worst(person))
        assert [message["state"] for message in person.of("decision")][-1] == "auto", name


def test_a_screen_plugged_in_later_shows_everything():
    person = Person((0, lambda simulation: simulation.screen.plug(False)), (6, lambda simulation: simulation.screen.plug(True)))
    drive(person, limit_s=9.0)
    simulation = person.simulation
    assert bright(simulation, *cell(0, 290)) == WHITE and bright(simulation, *BUTTONS[START]) > 0
    assert all(len(colours(simulation, 0, 182 + 18 * line, 240, 18)) > 2 for line in range(4))


def test_a_run_with_touches_replays_to_the_same_decisions(tmp_path):
    from host.recording import Reader
    from host.replay.rerun import rerun
    from host.replay.tape import Tape
    from host.twin.process import CHIP

    path = tmp_path / "touched.rec"
    person = Person((READY_S, touch(START)), (READY_S + 1.5, touch(STOP)))
    run("Z", width=550, watch=person, limit_s=READY_S + 2, changes={"screen.kind": "usart-gpu", "drive.autostart": False}, record=path)
    reader = Reader(path)
    tape = Tape(reader)
    again = rerun(tape, reader.header.robot, chip=CHIP)
    assert len(tape.then.decisions) > 20
    assert again.log.writes == tape.then.writes


def test_the_command_line_keeps_what_the_screen_shows(tmp_path, capsys):
    shown = tmp_path / "screen.png"
    assert main(["Z", "--width", "900", "--scale", "0.5", "--screen", str(shown), "--no-record"]) == 0
    assert f"screen: {shown}" in capsys.readouterr().out and shown.stat().st_size > 1000
    assert main(["Z", "--screen", str(tmp_path / "screen.svg")]) == 2
    assert ".png" in capsys.readouterr().err


def test_a_screen_takes_no_more_than_its_buffer_and_knows_only_its_own_words():
    screen = Screen("usart-gpu", 115200)
    screen.receive(0, b"CLR(0);DS16(4,4,'a;b',15);BOXF(1,2,3);\r\n")
    assert list(screen.refused) == [b"CLR(0)", b"BOXF(1,2,3)"] and screen.done == 1
    slow = Screen("nextion", 115200)
    slow.factor = 1000.0
    for _ in range(20):
        slow.receive(0, b"fill 0,0,9,9,0\xff\xff\xff".ljust(192, b"\xff"))
    assert slow.lost > 0
