"""What a newcomer meets first: the README, the pages and drawings that are made from the firmware, the moving picture, the site, the installing."""

import io
import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

from host import reference, site, wiring
from host.drawings import animation, style
from host.twin import courses, load_config
from host.twin.vehicle import Vehicle
from host.wiring import drawing, pages, power

ROOT = Path(__file__).resolve().parents[2]
SCREEN = 34  # rows of text that a usual window shows of a page; a row has about 150 characters, a picture is 17 rows
PICTURE, WIDE = 17, 150


def test_the_readme_fits_two_screens_but_for_its_pictures():
    rows = 0
    pictures = 0
    for line in (ROOT / "README.md").read_text().splitlines():
        pictures += "<img" in line
        rows += 0 if "<img" in line else max(1, -(-len(re.sub(r"\]\([^)]*\)", "]", line)) // WIDE))
    assert pictures == 3
    assert rows <= 2 * SCREEN


def test_the_readme_has_two_commands_to_try_and_they_are_words_of_make():
    text = (ROOT / "README.md").read_text()
    words = re.findall(r"^    make ([a-z]+)", text, re.MULTILINE)
    made = set(re.findall(r"^([a-z][a-z-]*):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    assert words == ["demo", "test"] and set(words) <= made


@pytest.mark.parametrize("path", reference.pages(), ids=lambda path: path.name)
def test_reference_pages_are_those_of_the_firmware(path):
    assert path.read_text() == reference.pages()[path], "say make reference"


def test_the_reference_says_what_robot_json_refuses():
    from params import schema

    text = reference.text()
    for key, _, _, low, high, _, meaning in schema.rows(schema.BOOT, schema.LIVE):
        row = next(line for line in text.split(f"\n## {key.partition('.')[0]}\n")[1].splitlines() if line.startswith(f"| `{key.partition('.')[2] or key}` |"))
        assert meaning in row
        if isinstance(low, int) and not isinstance(low, bool):
            assert f"{low} .. {high}" in row


def test_the_wiring_page_and_its_drawing_are_those_of_robot_json():
    assert wiring.PAGE.read_text() == pages.renew(wiring.PAGE.read_text()), "say make reference"
    assert wiring.DRAWING.read_text() == drawing.draw(wiring.wiring()), "say make reference"


def test_every_wire_of_a_robot_is_drawn_once_and_no_word_leaves_its_page():
    config = load_config(None, None, {"screen.kind": "nextion", "lidar.rx": 34, "axles.spacings": [100] * 5, "motors.channels": [10, 8, 6, 4, 2, 0]})
    for wheels in ("channels", "directions", "trims", "low", "high", "pulse_low", "pulse_high"):
        config["servos"].pop(wheels)
    config["motors"].pop("directions")
    wired = wiring.wiring(config)
    root = ElementTree.fromstring(drawing.draw(wired))
    words = [element.text for element in root.iter() if element.tag.endswith("text")]
    for gpio in ("34", "25", "26", "32", "27", "35", "22", "21", "33"):
        assert words.count(gpio) == 1 or gpio in ("25",), gpio
    assert words.count("axle 6 right") == 2  # its servo and its motor
    assert [words[words.index(pair) + 1] for pair in ("10, 11", "0, 1")] == ["axle 1 left", "axle 6 left"]
    wide, high = (float(root.get(name)) for name in ("width", "height"))
    for element in root.iter():
        if element.tag.endswith("text"):
            assert 0 <= float(element.get("x")) <= wide and 0 <= float(element.get("y")) <= high


def test_a_motor_that_runs_the_other_way_has_its_inputs_exchanged():
    wired = wiring.wiring(load_config(None, None, {"motors.directions": [-1, 1] * 5}))
    assert wired.motors["left"][0][:2] == (1, 0) and wired.motors["right"][0][:2] == (0, 1)


def test_the_power_budget_adds_up():
    budget = {supply.name: supply for supply in power.supplies(wiring.wiring(), servo=(1.0, 2.0), motor=(0.5, 1.0))}
    assert budget["servos"].most == 20 and budget["motors"].usual == 5
    assert budget["logic"].most == pytest.approx(0.5 + 0.6 + 0.03)


@pytest.mark.parametrize("arguments", (["nothing.json"], ["--to", "wiring.png"], ["--servo", "2,1"]))
def test_the_wiring_tool_says_what_is_wrong(arguments):
    done = subprocess.run([sys.executable, "-m", "host.wiring", *arguments], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 2 and "Traceback" not in done.stderr and arguments[-1].split(",")[0] in done.stderr


def test_the_moving_picture_moves_the_robot(tmp_path):
    """Three moments: body, wheels and a red point are where they should be."""
    course, vehicle = courses.make("Z", 450), Vehicle.from_settings(load_config())
    moments = [animation.Moment(0.2 * k, (225.0, -50.0 + 800 * k, 0.0), np.zeros(10), np.array([(390.0, 200.0 + 800 * k)]), [2], None) for k in range(3)]
    painter = animation.Painter(course, vehicle, moments)
    animation.write(painter, 3, tmp_path / "short.gif")
    with Image.open(tmp_path / "short.gif") as shown:
        assert (shown.n_frames, shown.format, shown.info["loop"]) == (3, "GIF", 0)
        assert shown.size == painter.size
        for k in range(3):
            shown.seek(k)
            red = _colour(shown, painter, (390.0, 200.0 + 800 * k))
            assert np.abs(red - np.array((209, 73, 91))).max() < 25
            assert _colour(shown, painter, (225.0 + 125 - 8, 133.5 - 50 + 800 * k)).max() < 80  # a wheel
            assert _colour(shown, painter, (225.0 + 60, 60.0 - 50 + 800 * k)).min() > 245  # the body


def _colour(shown, painter, place):
    at = [int(v / animation.FINE) for v in painter.on([place])[0]]
    return np.array(shown.convert("RGB").getpixel(tuple(at)), int)


def test_the_readme_s_picture_is_one_of_a_whole_run():
    with Image.open(animation.TARGET) as shown:
        assert shown.n_frames > 80
    assert animation.TARGET.stat().st_size < 1_500_000


def test_the_site_has_every_page_and_what_it_links_to(tmp_path):
    folder = site.lay_out(tmp_path / "pages")
    for page in site.page_files():
        text = (folder / ("index.md" if page.name == "README.md" and page.parent == Path() else page)).read_text()
        place = (folder / page).parent
        for target in re.findall(r"\]\(([^)\s#]+)", text):
            assert "://" in target or (place / target).exists(), f"{page}: {target}"
    named = {name if name.endswith(".md") else f"docs/{name}.md" for _, names in site.NAV for name in ([names] if isinstance(names, str) else names)}
    assert named <= {"index.md" if str(page) == "README.md" else str(page) for page in site.page_files()}


def test_installing_shows_steps_and_not_all_that_pip_says():
    sys.path.insert(0, str(ROOT / "tools"))
    import install

    class Terminal(io.StringIO):
        def isatty(self):
            return True

    said = ("Collecting numpy>=1.26 (from x)", "  Downloading numpy.whl (18 MB)", "WARNING: who knows", "Installing collected packages: a, b, c")
    for out, rows in ((Terminal(), 1), (io.StringIO(), 2)):
        show = install.Shower(out)
        for line in said:
            show.line(line)
        show.end()
        assert "WARNING" not in out.getvalue() and "unpacking 3 packages" in out.getvalue()
        assert out.getvalue().count("\n") == rows


def test_colours_of_the_picture_are_those_of_the_drawings():
    assert {style.RED, style.BLUE, style.YELLOW, style.GREEN} == set(animation.STRONG)
