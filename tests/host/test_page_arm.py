"""The arm on the monitor's page, in a real browser, with the firmware in the twin behind it."""

import pytest
from open_page import ROOT, Monitor, needs_browser

from host.arm import model, reach
from host.arm.page import FOLDER, listing

pytestmark = needs_browser

NAME = "test-of-the-page"
STATE = "return document.querySelector('#panel-arm [data-id=state]')?.textContent || ''"
ANGLE = "return Number(document.querySelector('#panel-arm .joint output')?.textContent.replace('°', ''))"


@pytest.fixture
def page(browser, tmp_path):
    """A short reach in out/arm/, and the twin with its arm."""
    arm = model.load("paper-3r")
    path = ROOT / FOLDER / f"{NAME}.json"
    q = [[1.6, -0.4, 0.3], [2.2, -0.9, 0.5]]
    reach.write(reach.from_points(arm, (), (0, 3), reach.np.array(q), 0 * reach.np.array(q)), path)
    page = Monitor(browser, f"twin:z?width=620&autostart=0&arm={model.ARMS / 'paper-3r.json'}")
    page.size(1440, 900)
    yield page
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    page.close()
    path.unlink()


def _button(page, name):
    page.js(f"document.querySelector('#panel-arm [data-id={name}]').click()")


def test_the_arm_is_switched_on_plays_is_held_and_moved_by_hand(page):
    assert page.until(lambda: page.js("return !document.getElementById('tab-arm').hidden"))
    page.tab("arm")
    assert page.until(lambda: "without power" in page.js(STATE))
    assert page.until(lambda: page.js(f"return [...document.querySelectorAll('#panel-arm option')].some((one) => one.value === '{NAME}')"))
    page.js(f"const one = document.querySelector('#panel-arm select'); one.value = '{NAME}'; one.dispatchEvent(new Event('change'))")
    blank = page.js("return document.querySelector('#panel-arm canvas').toDataURL()")
    # Refused while the lidar has not begun: asked again, as a person would.
    assert page.until(lambda: (page.js(STATE) and _button(page, "home")) or page.until(lambda: page.js(STATE).startswith("holds"), 3), 30)
    _button(page, "play")
    assert page.until(lambda: page.js(STATE) == "plays", 25)  # first slowly to where it begins
    assert page.until(lambda: page.js(ANGLE) > 100)
    _button(page, "hold")
    assert page.until(lambda: page.js(STATE) == "holds: told to hold")
    held = page.js(ANGLE)
    assert 100 < held < 126
    page.keep_screenshot("monitor-arm.png")
    assert page.js("return document.querySelector('#panel-arm canvas').toDataURL()") != blank
    page.js("const one = document.querySelector('#panel-arm .joint input'); one.value = 95; one.dispatchEvent(new Event('change'))")
    assert page.until(lambda: page.js(ANGLE) == 95 and page.js(STATE) == "holds")
    _button(page, "save")
    assert page.until(lambda: page.js("return document.querySelector('#panel-arm [data-id=poses]').textContent.includes('pose 1')"))
    _button(page, "home")
    assert page.until(lambda: page.js(ANGLE) == 90 and page.js(STATE) == "holds")


def test_what_is_listed_is_what_can_be_played(tmp_path):
    (tmp_path / "bad.json").write_text('{"format": "arm-reach-1"')
    arm = model.load("mt-arm")
    q = reach.np.array([[1.6, -0.4, 0.3], [2.0, -0.9, 0.5]])
    reach.write(reach.from_points(arm, (), (0, 3), q, 0 * q), tmp_path / "good.json")
    told = listing(tmp_path)
    assert [one["name"] for one in told["list"]] == ["good"] and "bad.json" in told["wrong"][0]
    one = told["list"][0]
    assert bytes.fromhex("".join(one["pieces"]))[:3] == b"GR\x01" and len(one["angles"][0]) == 5 and one["arm"]["names"][-1] == "gripper"
    assert listing(tmp_path / "none") == {"type": "reaches", "list": [], "wrong": []}
