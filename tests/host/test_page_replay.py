"""Recordings on the monitor's page, in a real browser: all of one at once, seeking, another beside it, and driven again with other settings."""

import time

import pytest
from open_page import ROOT, Monitor, needs_browser

from host import recording
from host.link import messages
from host.twin import run
from link import frames, protocol

pytestmark = needs_browser
COLOURED = """
const probe = Object.assign(document.createElement("canvas"), { width: 1, height: 1 }).getContext("2d");
probe.fillStyle = getComputedStyle(document.documentElement).getPropertyValue(`--${arguments[1]}`);
probe.fillRect(0, 0, 1, 1);
const [r, g, b] = probe.getImageData(0, 0, 1, 1).data, canvas = document.getElementById(arguments[0]);
const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
let count = 0;
for (let i = 0; i < data.length; i += 4) if (Math.abs(data[i] - r) + Math.abs(data[i + 1] - g) + Math.abs(data[i + 2] - b) < 12) count++;
return count;
"""


@pytest.fixture(scope="module")
def recordings():
    """Two runs of the twin in out/, from which alone a page may open recordings."""
    folder = ROOT / "out" / "test-page-replay"
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / name for name in ("one.rec", "two.rec")]
    for path, seed in zip(paths, (0, 4)):
        path.unlink(missing_ok=True)
        run("Z", 620, seed=seed, limit_s=9, record=str(path))
    yield [str(path.relative_to(ROOT)) for path in paths]
    for path in paths:
        path.unlink()
    folder.rmdir()


@pytest.fixture(scope="module")
def page(browser, recordings):
    page = Monitor(browser, f"file:{recordings[0]}")
    page.size(1440, 900)
    page.js("document.querySelector('#spans [data-value=Infinity]').click()")
    assert page.until(lambda: page.browser.find_element("id", "player").is_displayed() and page.text("place"))
    page.click("play")
    assert page.until(lambda: page.text("play") == "Play")
    yield page
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    page.close()


def seek(page, at):
    page.js("const one = document.getElementById('position'); one.value = arguments[0]; one.dispatchEvent(new Event('input'))", at)
    assert page.until(lambda: page.text("clock").startswith(f"0:0{at:.1f}"))
    time.sleep(0.3)
    page.frames(2)


def test_all_of_it_is_seen_at_once_and_seeking_leaves_no_stray_lines(page):
    seek(page, 4)
    world, charts = page.picture("world"), page.picture("charts")
    track = page.js(COLOURED, "world", "chosen")
    for _ in range(2):  # and having played on from there
        page.click("play")
        time.sleep(0.5)
    assert page.until(lambda: page.text("play") == "Play")
    seek(page, 8)
    assert page.picture("world") != world
    seek(page, 1)
    assert page.js(COLOURED, "charts", "text") > 300  # decisions that have not been played yet
    seek(page, 4)
    assert page.picture("world") == world and page.picture("charts") == charts and page.js(COLOURED, "world", "chosen") == track


def test_a_click_on_the_charts_goes_there(page):
    page.js("""const one = document.getElementById("charts"), box = one.getBoundingClientRect();
        one.dispatchEvent(new MouseEvent("click", { clientX: box.x + 0.5 * box.width, clientY: box.y + 50, bubbles: true }))""")
    assert page.until(lambda: page.text("clock").startswith("0:04")), page.text("clock")


def test_another_one_is_shown_beside_it(page, recordings):
    assert page.js(COLOURED, "world", "other") == page.js(COLOURED, "charts", "other") == 0
    page.tab("record")
    page.click("recordings")
    found = "return [...document.querySelectorAll('#recorded li')].find((one) => one.textContent.includes(arguments[0]))"
    assert page.until(lambda: page.js(found, recordings[1]))
    page.js(found.replace("return ", "").rstrip() + ".lastChild.click()", recordings[1])
    assert page.until(lambda: page.text("beside-name") == recordings[1])
    page.frames(2)
    assert page.js(COLOURED, "world", "other") > 30 and page.js(COLOURED, "charts", "other") > 50
    page.keep_screenshot("monitor-beside.png")
    page.click("beside-none")
    assert page.until(lambda: not page.browser.find_element("id", "beside").is_displayed())
    page.frames(2)
    assert page.js(COLOURED, "world", "other") == 0


def test_it_is_driven_again_with_other_settings(page):
    page.tab("record")
    field = page.browser.find_element("id", "changes")
    for text, says in (("avoid.margin", "write section.key=value"), ("avoid.marjin=20", "marjin")):
        field.clear()
        field.send_keys(text)
        page.js("document.querySelector('#again-with button').click()")
        assert page.until(lambda says=says: says in page.text("again-note")), page.text("again-note")
    field.clear()
    field.send_keys("avoid.margin=30")
    page.js("document.querySelector('#again-with button').click()")
    assert page.until(lambda: "differ, the first at" in page.text("beside-name")), page.text("again-note")
    assert page.text("beside-name").startswith("avoid.margin 30: ")
    page.frames(2)
    assert page.js(COLOURED, "charts", "other") > 50


def test_a_recording_with_raw_scans_has_them(monitor):
    page = monitor("twin:random?seed=3")
    page.size(1440, 900)
    assert page.until(lambda: page.speeds())
    page.tab("record")
    page.click("with-scans")
    page.click("record")
    time.sleep(2.5)
    page.click("record")
    assert page.until(lambda: page.text("saved").endswith(".rec"))
    path = ROOT / page.text("saved")
    try:
        reader, told = frames.FrameReader(), []
        for record in recording.Reader(path):
            if record.stream == recording.Stream.TELEMETRY:
                told += [messages.decode(kind, payload) for kind, _, payload in reader.read(record.data) if kind == protocol.SCAN]
        assert len(told) > 3 and all(len(scan["distances"]) > 300 for scan in told)
    finally:
        path.unlink()


def test_a_run_of_the_twin_that_is_recorded_from_its_start_can_be_driven_again(monitor):
    page = monitor("twin:z?width=620&speed=20&autostart=1")
    page.size(1440, 900)
    page.tab("twin")
    assert page.until(lambda: page.browser.find_elements("css selector", ".courses button"))
    page.js(
        "document.querySelector('#panel-twin [data-id=size]').value = 700; document.querySelector('#panel-twin [data-id=record]').click(); document.querySelector('#panel-twin [data-id=form] button.main').click()"
    )
    page.tab("record")
    assert page.until(lambda: page.text("saved").endswith("-twin.rec"))
    path = page.text("saved")
    try:
        page.click("saved")
        assert page.until(lambda: page.browser.find_element("id", "again-with").is_displayed())
        page.js("document.querySelector('#again-with button').click()")
        assert page.until(lambda: "decisions compared: all the same" in page.text("beside-name")), page.text("again-note")
    finally:
        (ROOT / path).unlink()
