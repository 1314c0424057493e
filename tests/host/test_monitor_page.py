"""The monitor's page in a real browser: that it drives, stops, tunes, records and replays, with the twin behind it."""

import re
import time

from open_page import ROOT, needs_browser

from host import recording

pytestmark = needs_browser


def test_the_robot_is_seen_to_drive_and_stop_stops_it(monitor):
    page = monitor("twin:z?width=620")
    page.size(1440, 900)
    page.theme("dark")
    assert page.until(lambda: page.text("state") == "auto")
    assert page.until(lambda: page.speeds() and max(page.speeds()) > 100)
    assert page.colours("map") > 20 and page.colours("world") > 5 and page.colours("charts") > 10
    first, before = page.picture("map"), page.place()
    assert page.until(lambda: page.picture("map") != first and page.place()[:2] != before[:2])
    page.click("scan")
    time.sleep(4)
    assert page.text("reason")
    page.keep_screenshot("monitor.png")
    page.click("stop")
    assert page.until(lambda: page.text("state") == "stopped" and max(map(abs, page.speeds())) == 0)
    time.sleep(0.5)
    stands = page.place()
    time.sleep(0.7)
    assert page.place() == stands
    page.click("auto")
    assert page.until(lambda: page.text("state") == "auto" and page.place()[:2] != stands[:2])


def test_driving_by_hand_lasts_as_long_as_the_key_is_held(monitor):
    page = monitor("twin:random?seed=3")
    assert page.until(lambda: page.speeds())
    page.press("Space")
    assert page.until(lambda: page.text("state") == "stopped")
    page.press("Digit5")
    page.press("ArrowUp")
    assert page.until(lambda: page.text("state") == "manual" and max(page.speeds()) > 50)
    page.press("ArrowUp", "keyup")
    assert page.until(lambda: max(map(abs, page.speeds())) == 0)
    page.press("ArrowUp")
    assert page.until(lambda: max(page.speeds()) > 50)
    page.browser.get("about:blank")  # the page is lost with the key held down
    began = time.monotonic()
    page.browser.get(page.url)
    assert page.until(lambda: page.speeds() and max(map(abs, page.speeds())) == 0 and page.text("state") == "stopped"), time.monotonic() - began


def test_a_parameter_is_tuned_and_comes_back_from_the_robot(monitor):
    page = monitor("twin:z?width=620")
    assert page.until(lambda: page.browser.find_elements("id", "parameter-avoid.margin"))
    field = page.browser.find_element("id", "parameter-avoid.margin")
    before = field.get_attribute("value")
    page.browser.execute_script("arguments[0].value = 22; arguments[0].dispatchEvent(new Event('input'))", field)
    changed = "return document.getElementById('parameter-avoid.margin').closest('.parameter').classList.contains('changed')"
    assert before != "22" and page.until(lambda: page.browser.execute_script(changed))
    # It counts from the next start, which the page offers; the robot comes back with what was kept.
    notice = page.browser.find_element("id", "next-start")
    page.tab("tune")
    assert page.until(notice.is_displayed)
    page.click("keep-restart")
    assert page.until(lambda: not notice.is_displayed() and page.browser.find_elements("id", "parameter-avoid.margin"), 60)
    assert page.browser.find_element("id", "parameter-avoid.margin").get_attribute("value") == "22"


def test_a_trim_is_told_while_it_is_dragged(monitor):
    page = monitor("twin:random?seed=3")
    assert page.until(lambda: page.browser.find_elements("id", "parameter-servos.trims.2"))
    page.click("stop")
    drag = """const one = document.getElementById("parameter-servos.trims.2").parentNode.querySelector("[type=range]");
        window.told = []; const send = WebSocket.prototype.send;
        WebSocket.prototype.send = function (text) { const what = JSON.parse(text); if (what.do === "tune") told.push(what.value); send.call(this, text); };
        let value = 0;
        const timer = setInterval(() => {
          one.value = value += 0.5;
          one.dispatchEvent(new Event("input"));
          if (value >= 10) clearInterval(timer);
        }, 40)"""
    page.browser.execute_script(drag)
    assert page.until(lambda: page.browser.execute_script("return told.at(-1) === 10 && told.length > 3"))
    assert not page.browser.find_element("id", "player").is_displayed()


def test_a_drive_is_recorded_and_replayed(monitor, tmp_path):
    path = tmp_path / "drive.rec"
    page = monitor("twin:z?width=620", "--record", str(path))
    assert page.until(lambda: page.speeds() and max(page.speeds()) > 100)  # it drives by now, on a busy computer as well
    time.sleep(3)
    page.process.terminate()
    page.process.wait(10)
    assert any(record.stream == recording.Stream.LIDAR for record in recording.Reader(path))
    page.browser.get("about:blank")
    page.browser.get_log("browser")

    page = monitor(f"file:{path}")
    assert page.until(lambda: page.browser.find_element("id", "player").is_displayed() and page.text("place"))
    assert page.until(lambda: page.browser.find_element("id", "play").text == "Play")
    end = page.place()
    page.browser.execute_script("const one = document.getElementById('position'); one.value = 0.5; one.dispatchEvent(new Event('input'))")
    assert page.until(lambda: page.place() != end and page.text("clock").startswith("0:00.5"))
    assert not page.browser.find_element("id", "stop").is_enabled()


def test_it_fits_a_phone(monitor):
    page = monitor("twin:z?width=620")
    page.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": True})
    try:
        assert page.until(lambda: page.text("state") == "auto" and page.speeds() and max(page.speeds()) > 100)
        assert page.browser.execute_script("return document.documentElement.scrollWidth <= innerWidth")
        stop = page.browser.execute_script("return document.getElementById('stop').getBoundingClientRect().toJSON()")
        assert stop["bottom"] <= 844 and stop["height"] >= 44 and stop["width"] >= 100
        page.browser.execute_script("scrollTo(0, 99999)")
        page.browser.find_element("id", "stop").click()
        assert page.until(lambda: page.text("state") == "stopped")
    finally:
        page.browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def test_a_gamepad_drives(monitor):
    page = monitor("twin:random?seed=3")
    assert page.until(lambda: page.speeds())
    page.click("stop")
    assert page.until(lambda: page.text("state") == "stopped")
    pad = """window.pad = {id: "pad", axes: [0.15, 0], buttons: Array.from({length: 10}, () => ({pressed: false}))};
        Object.defineProperty(navigator, "getGamepads", {value: () => [window.pad]})"""
    page.browser.execute_script(pad)
    time.sleep(1)  # it is seen at rest, which is no command, wherever it rests
    assert page.text("state") == "stopped"
    page.browser.execute_script("window.pad.axes = [0.15, -1]")
    assert page.until(lambda: page.text("state") == "manual" and max(page.speeds()) > 100)
    page.browser.execute_script("window.pad.axes = [0.2, 0.02]")
    assert page.until(lambda: max(map(abs, page.speeds())) == 0)
    page.browser.execute_script("window.pad.axes = [1, 0]; window.pad.buttons[5].pressed = true")
    assert page.until(lambda: page.browser.find_elements("css selector", "#modes [aria-checked=true]")[0].text.startswith("2"))
    page.browser.execute_script("window.pad.axes = [0, 0]; window.pad.buttons[0].pressed = true")
    assert page.until(lambda: page.text("state") == "stopped")


def test_a_speed_set_by_key_springs_back_when_the_key_is_let_go(monitor):
    from selenium.webdriver import ActionChains
    from selenium.webdriver.common.keys import Keys

    page = monitor("twin:random?seed=3")
    assert page.until(lambda: page.speeds())
    page.click("stop")
    assert page.until(lambda: page.text("state") == "stopped")
    lever = page.browser.find_element("id", "v")
    page.browser.execute_script("arguments[0].scrollIntoView({block: 'center'}); arguments[0].value = 110; arguments[0].focus()", lever)
    ActionChains(page.browser).key_down(Keys.ARROW_UP).perform()
    assert page.until(lambda: page.text("state") == "manual" and max(page.speeds()) > 100)
    ActionChains(page.browser).key_up(Keys.ARROW_UP).perform()
    assert page.until(lambda: max(map(abs, page.speeds())) == 0)


def test_a_run_that_is_over_says_so_and_offers_another_course(monitor):
    from selenium.webdriver.support.ui import Select

    page = monitor("twin:z?width=620&speed=20")
    assert page.until(lambda: page.browser.find_element("id", "over").is_displayed())
    assert page.text("over-text").startswith("pass") and page.text("state") == "ended"
    for name in ("auto", "manual", "stop", "keep", "record", "af", "parameter-avoid.margin"):
        assert not page.browser.find_element("id", name).is_enabled(), name
    page.press("ArrowUp")  # nobody is there to be driven
    assert not page.browser.execute_script("return document.getElementById('manual').classList.contains('on')")
    Select(page.browser.find_element("id", "course")).select_by_visible_text("random")
    assert page.text("size-name") == "gap"
    page.click("drive-again")
    assert page.until(lambda: page.text("address") == "twin:random?speed=20&gap=500&seed=0" and page.text("state") == "auto")
    assert not page.browser.find_element("id", "over").is_displayed() and page.browser.find_element("id", "stop").is_enabled()


def test_a_bad_address_is_explained_beside_it_and_the_robot_stays(monitor):
    page = monitor("twin:z?width=620")
    assert page.until(lambda: page.text("state") == "auto")
    page.click("stop")  # the course is not to come to its end meanwhile
    assert page.until(lambda: page.text("state") == "stopped")
    page.tab("record")
    where = page.browser.find_element("id", "where")
    for address, says in (("twin:z?width=20", "260 to 3000"), ("twin:q", "courses are"), ("robot", "no address"), ("file:nothing.rec", "cannot read")):
        where.clear()
        where.send_keys(address)
        page.browser.find_element("css selector", "#open button").click()
        assert page.until(lambda says=says: says in page.text("open-trouble")), (address, page.text("open-trouble"))
        assert page.text("address") == "twin:z?width=620" and page.text("state") == "stopped"
    where.send_keys("x")
    assert page.text("open-trouble") == ""


def test_keep_says_what_was_kept_and_the_twin_drives_with_it_again(monitor):
    page = monitor("twin:z?width=620&speed=3")
    assert page.until(lambda: page.browser.find_elements("id", "parameter-avoid.margin"))
    cruise = "const one = document.getElementById('parameter-drive.cruise'); one.value = 112; one.dispatchEvent(new Event('input'))"
    page.browser.execute_script(cruise)
    page.tab("tune")
    page.click("keep")
    assert page.until(lambda: page.text("kept"))
    assert "drive.cruise 112" in page.text("kept") and "out/twin/robot.json" in page.text("kept")
    page.tab("record")
    page.click("again")
    value = "return document.getElementById('parameter-drive.cruise')?.value"
    assert page.until(lambda: "config=" in page.text("address") and page.browser.execute_script(value) == "112")


def test_a_recording_is_saved_linked_and_listed(monitor):
    page = monitor("twin:z?width=620")
    assert page.until(lambda: page.speeds() and max(page.speeds()) > 100)
    page.tab("record")
    page.click("record")
    time.sleep(2)
    page.click("record")
    assert page.until(lambda: page.text("saved").endswith(".rec"))
    path = page.text("saved")
    try:
        page.click("recordings")
        entry = "return [...document.querySelectorAll('#recorded li')].map((one) => [one.textContent, one.querySelector('polyline')?.points.length])"
        assert page.until(lambda: page.browser.execute_script(entry))
        (text, places) = next(row for row in page.browser.execute_script(entry) if path in row[0])
        assert re.match(r"0:0[1-9], ended by hand", text) and places > 10
        page.click("saved")
        assert page.until(lambda: page.text("address") == f"file:{path}" and page.browser.find_element("id", "player").is_displayed())
    finally:
        (ROOT / path).unlink()


def test_after_power_up_it_waits_until_a_person_starts_it(monitor):
    page = monitor("twin:z?width=620&autostart=0")
    assert page.until(lambda: page.text("state") == "waiting")
    assert "waiting for a start" in page.text("reason") and page.text("auto").startswith("Start")
    time.sleep(1)
    assert max(map(abs, page.speeds())) == 0
    page.click("auto")
    assert page.until(lambda: page.text("state") == "auto" and max(page.speeds()) > 100)
    assert page.text("auto").startswith("Auto")
