"""planner/tables.py: what is read from the file is what would have been made, and no file stops the start."""

import os
import sys

from params.config import Config
from planner import make_tables, tables
from planner.candidates import Candidates
from planner.cost_to_go import CostToGo

_FOLDER = "tables_test"
_MAKERS = ("make_tables", "candidate_tables", "footprint_masks", "primitives", "primitives_naws")


def _in_a_robots_folder(check):
    """Call check in a folder with a robot.json, which is removed afterwards."""
    before = os.getcwd()
    os.mkdir(_FOLDER)
    os.chdir(_FOLDER)
    try:
        with open("robot.json", "w") as file:
            file.write("{}")
        check()
    finally:
        for name in os.listdir():
            os.remove(name)
        os.chdir(before)
        os.rmdir(_FOLDER)


def _all(config):
    return [bytes(a) for a in tables.load(config, 0)] + [bytes(a) for a in tables.load(config, 1)]


def _content():
    with open("tables.bin", "rb") as file:
        return file.read()


def _put(content):
    with open("tables.bin", "wb") as file:
        file.write(content)


def _nothing_is_made(config):
    """The tables of a config, where no code that makes them may be loaded."""
    original = make_tables.make
    make_tables.make = None
    sys.modules["planner.make_tables"] = make_tables
    try:
        return _all(config)
    finally:
        make_tables.make = original


def test_the_board_reads_what_was_saved_and_makes_nothing():
    def check():
        for mode in ("AWS", "NAWS"):
            config = Config({"mode": mode})
            made = _all(config)
            os.remove("tables.bin")
            tables.save(config, "tables.bin")
            assert _nothing_is_made(config) == made

    _in_a_robots_folder(check)


def test_what_the_board_made_it_finds_again():
    def check():
        config = Config()
        made = _all(config)
        assert _nothing_is_made(config) == made
        found = _content()
        tables.save(config, "tables.bin")
        assert _content() == found

    _in_a_robots_folder(check)


def test_each_parameter_that_the_tables_depend_on_makes_them_anew():
    def check():
        config = Config()
        _all(config)
        before = _content()
        for key, value in (("mode", "NAWS"), ("avoid.margin", 8), ("avoid.soft_margin", 29), ("windows.look_ahead", 800), ("robot.width", 310)):
            section, _, name = key.partition(".")
            other = Config({section: {name: value}} if name else {key: value})
            made = _all(other)
            assert _content()[:12] != before[:12], key
            assert _nothing_is_made(other) == made

    _in_a_robots_folder(check)


def test_a_damaged_or_foreign_file_is_made_anew():
    def check():
        config = Config()
        made = _all(config)
        good = _content()
        damaged = [good[:n] for n in (0, 1, 11, 12, 13, 29, 40, 1000, 4000, len(good) - 1)]
        damaged += [good[:n] + bytes((good[n] ^ 0xFF,)) + good[n + 1 :] for n in (0, 4, 8, 12, 13, 32, 60, 3000, len(good) - 1)]
        damaged.append(b"something else altogether" * 100)
        for content in damaged:
            _put(content)
            assert _all(config) == made, len(content)
            assert _content() == good, len(content)

    _in_a_robots_folder(check)


def test_without_a_robot_json_nothing_is_left_behind():
    Candidates(Config())
    assert "tables.bin" not in os.listdir()


def test_the_code_that_makes_the_tables_is_let_go():
    CostToGo(Config())
    Candidates(Config())
    if sys.implementation.name == "micropython":
        assert not [name for name in _MAKERS if "planner." + name in sys.modules]


def test_margins_are_those_of_this_start_whatever_was_made_before():
    def masks(margin):
        config = Config({"avoid": {"margin": margin, "soft_margin": 100}})
        made = CostToGo(config)
        return bytes(made.masks), made.grid[4]  # how far a mask reaches

    wide = masks(90)
    narrow = masks(5)
    assert masks(90) == wide and masks(5) == narrow
    # The half diagonal of the outline with its margin, in cells of 1/12 body length.
    for (_, reach), margin in ((wide, 90), (narrow, 5)):
        assert reach == int(((125 + margin) ** 2 + (300 + margin) ** 2) ** 0.5 / 50 + 0.25), (reach, margin)
