"""What the parts of the monitor's page do, in a real browser: maps, charts, tuning, gamepads, the twin's time and its box."""

import math
import re
import time

import pytest
from open_page import Monitor, needs_browser

pytestmark = needs_browser

# Another page's end of the WebSocket, in this page: what is told, and what a command brings about.
LISTEN = """
window.told = [];
window.socket = new WebSocket(`ws://${location.host}/live${location.search}`);
socket.onmessage = (event) => told.push(...JSON.parse(event.data));
"""
# What the words beside the pointer say at places of a canvas, given as shares of its width and height.
HOVER = """
const [id, places, done] = arguments, canvas = document.getElementById(id), box = canvas.getBoundingClientRect(), out = [];
const next = () => {
  if (!places.length) return done(out);
  const [x, y] = places.shift(), at = { clientX: box.x + x * box.width, clientY: box.y + y * box.height, bubbles: true, pointerId: 1, pointerType: "mouse" };
  canvas.dispatchEvent(new PointerEvent("pointermove", at));
  requestAnimationFrame(() => requestAnimationFrame(() => {
    out.push(canvas.parentNode.querySelector(".tip").textContent);
    next();
  }));
};
next();
"""
# How many lines one drawing of the map strokes.
STROKES = """
const done = arguments[0], map = document.getElementById("map").getContext("2d"), stroke = CanvasRenderingContext2D.prototype.stroke;
let count = 0;
CanvasRenderingContext2D.prototype.stroke = function (...what) { if (this === map) count++; return stroke.apply(this, what); };
const drawn = document.body.dataset.drawn, look = () => {
  if (document.body.dataset.drawn === drawn) return requestAnimationFrame(look);
  CanvasRenderingContext2D.prototype.stroke = stroke;
  done(count / (document.body.dataset.drawn - drawn));
};
look();
"""
ROW, FAN = [(0.02 * k, 0.5) for k in range(50)], [(0.38 + 0.024 * k, 0.2 + 0.02 * j) for k in range(11) for j in range(7)]


@pytest.fixture(scope="module")
def page(browser):
    page = Monitor(browser, "twin:z?width=620&scale=2")  # long enough for all that is driven here
    page.size(1440, 900)
    page.js(LISTEN)
    yield page
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    page.close()


@pytest.fixture(autouse=True)
def going(page):
    """No test begins in the pause that another one left, nor at the end of the course."""
    assert page.text("state") != "ended"
    page.js("if (window.socket?.readyState === 1) socket.send(JSON.stringify({ do: 'pace', paused: false, speed: 1 }))")


def latest(page, kind):
    return page.js("return told.filter((one) => one.type === arguments[0]).at(-1)", kind)


def count(page, kind):
    return page.js("return told.filter((one) => one.type === arguments[0]).length", kind)


def hover(page, name, *places):
    """Texts beside the pointer."""
    return page.browser.execute_async_script(HOVER, name, places)


def test_why_a_candidate_was_refused_is_told_where_it_is_pointed_at(page):
    many = "return told.findLast((one) => one.type === 'candidates')?.list.filter(({ free }) => free !== null && free < 500).length > 20"
    assert page.until(lambda: (latest(page, "decision") or {}).get("v", 90) > 90 and page.js(many))
    page.tab("twin")
    pause = page.browser.find_element("css selector", "#panel-twin [data-id=pause]")
    pause.click()  # so that what is pointed at stays
    assert page.until(lambda: page.text("state") == "paused")
    texts = hover(page, "map", *ROW, *FAN)
    refused = [text for text in texts if text.startswith("AF ")]
    assert any("mm, where the" in text and "comes within the margin of a point" in text for text in refused), [text for text in texts if not text[0].isdigit()]
    points = [text for text in texts if "remembered for" in text]
    assert any("planning" in text and "mm from the body" in text for text in points), [text for text in texts if not text[0].isdigit()]
    shown = page.browser.execute_async_script(STROKES)
    pause.click()
    page.click("stop")
    # Standing, nothing is being refused.
    assert page.until(lambda: page.text("state") == "stopped")
    assert not any(text.startswith("AF ") for text in hover(page, "map", *FAN))
    standing = page.browser.execute_async_script(STROKES)
    assert shown > 100 > standing > 5


def test_its_pace_is_shown_from_the_start(page):
    assert latest(page, "pace") == {"type": "pace", "speed": 1.0, "paused": False}
    assert page.js("return document.querySelector('#panel-twin [data-id=speeds] [aria-checked=true]').dataset.value") == "1"


def test_the_twin_stands_still_in_time_and_goes_on_by_one_decision(page):
    page.tab("twin")
    page.click("auto")
    assert page.until(lambda: page.text("state") == "auto")
    page.browser.find_element("css selector", "#panel-twin [data-id=pause]").click()
    assert page.until(lambda: page.text("state") == "paused")
    time.sleep(0.3)  # what was on its way
    before, decisions = latest(page, "truth")["time"], count(page, "decision")
    time.sleep(0.5)
    assert latest(page, "truth")["time"] == before and count(page, "decision") == decisions
    page.browser.find_element("css selector", "#panel-twin [data-id=step]").click()
    assert page.until(lambda: count(page, "decision") == decisions + 1 and latest(page, "pace")["paused"])
    time.sleep(0.5)
    assert count(page, "decision") == decisions + 1 and 0 < latest(page, "truth")["time"] - before < 1
    slow = page.browser.find_element("css selector", "#panel-twin [data-id=speeds] [data-value='0.1']")
    slow.click()
    page.browser.find_element("css selector", "#panel-twin [data-id=pause]").click()
    began, at = time.monotonic(), latest(page, "truth")["time"]
    time.sleep(1.2)
    assert 0 < latest(page, "truth")["time"] - at < 0.15 * (time.monotonic() - began)
    page.click("stop")  # the course is not to come to its end
    page.browser.find_element("css selector", "#panel-twin [data-id=speeds] [data-value='1']").click()


def beside(truth, walls):
    """Where a box of 200 mm, 480 mm from the robot, has nothing between: the unit step there."""
    for dx, dy in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        x, y = truth["x"] + 480 * dx, truth["y"] + 480 * dy
        left, right = min(truth["x"], x) - 105, max(truth["x"], x) + 105
        low, high = min(truth["y"], y) - 105, max(truth["y"], y) + 105
        if all(max(x1, x2) < left or min(x1, x2) > right or max(y1, y2) < low or min(y1, y2) > high for x1, y1, x2, y2 in walls):
            return dx, dy
    raise AssertionError(f"no room beside {truth}")


def test_a_box_is_put_into_its_way_and_dragged_and_the_lidar_sees_it(page):
    from selenium.webdriver import ActionChains

    page.click("stop")
    assert page.until(lambda: page.text("state") == "stopped")
    page.tab("twin")
    page.browser.find_element("css selector", "#panel-twin [data-id=box]").click()
    assert page.until(lambda: (latest(page, "box") or {}).get("size") == 200)
    first, truth = latest(page, "box"), latest(page, "truth")
    where = """const { walls } = told.findLast((one) => one.type === "world"), canvas = document.getElementById("world");
        const xs = walls.flatMap(([a, , b]) => [a, b]), ys = walls.flatMap(([, a, , b]) => [a, b]), { clientWidth: w, clientHeight: h } = canvas;
        const [l, r, b, t] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)], scale = Math.min(w / (r - l), h / (t - b)) * 0.94;
        return [...arguments].map(([x, y]) => [Math.round((x - (l + r) / 2) * scale), Math.round(-(y - (b + t) / 2) * scale)])"""
    dx, dy = beside(truth, latest(page, "world")["walls"])
    there = truth["x"] + 480 * dx, truth["y"] + 480 * dy
    # To where the robot is, which is refused, and then beside it.
    (x, y), (rx, ry), (tx, ty) = page.js(where, [first["x"], first["y"]], [truth["x"], truth["y"]], list(there))
    canvas = page.browser.find_element("id", "world")
    ActionChains(page.browser, duration=50).move_to_element_with_offset(canvas, x, y).click_and_hold().move_by_offset(rx - x, ry - y).release().perform()
    assert page.until(lambda: any("there stands the robot" in one["text"] for one in page.js("return told.filter((one) => one.type === 'text')")))
    now = latest(page, "box")
    ((x, y),) = page.js(where, [now["x"], now["y"]])
    ActionChains(page.browser, duration=50).move_to_element_with_offset(canvas, x, y).click_and_hold().move_by_offset(tx - x, ty - y).release().perform()
    assert page.until(lambda: math.dist((latest(page, "box")["x"], latest(page, "box")["y"]), there) < 40), latest(page, "box")
    seen = "const points = told.findLast((one) => one.type === 'points'); return points.x.some((x, i) => Math.hypot(x - arguments[0], points.y[i] - arguments[1]) < 60)"
    heading = math.radians(latest(page, "truth")["heading"])
    near = 480 - 100  # its side that faces the robot
    right, ahead = near * (dx * math.cos(heading) - dy * math.sin(heading)), near * (dx * math.sin(heading) + dy * math.cos(heading))
    assert page.until(lambda: page.js(seen, right, ahead))
    page.browser.find_element("css selector", "#panel-twin [data-id=box]").click()
    assert page.until(lambda: latest(page, "box")["size"] == 0)


def test_charts_have_axes_values_and_marks_and_can_be_scrolled(page):
    from selenium.webdriver.common.keys import Keys

    page.click("auto")
    assert page.until(lambda: page.text("state") == "auto" and page.speeds() and max(page.speeds()) > 50)
    page.click("stop")
    assert page.until(lambda: page.text("state") == "stopped")
    page.js("document.querySelector('#spans [data-value=Infinity]').click()")
    page.frames(2)
    texts = hover(page, "charts", *((0.1 + 0.01 * k, 0.5) for k in range(88)))
    assert any(re.search(r"V 1\d\d, decided in \d+\.\d ms, free \d+ mm: \w", text) for text in texts), texts
    assert any("stopped by command" in text for text in texts)
    assert page.until(lambda: page.js("return Number(document.getElementById('scroll').max)") > 11)
    # Ten seconds of it, scrolled to the beginning and back.
    page.js("document.querySelector('#spans [data-value=\"10\"]').click()")
    page.frames(2)
    late = float(hover(page, "charts", (0.9, 0.5))[0].split(" s")[0])
    page.js("const one = document.getElementById('scroll'); one.value = one.min; one.dispatchEvent(new Event('input'))")
    page.frames(2)
    early = float(hover(page, "charts", (0.9, 0.5))[0].split(" s")[0])
    one = page.browser.find_element("id", "charts")
    one.send_keys(Keys.ARROW_LEFT)
    page.frames(2)
    led = page.js("return document.querySelector('#charts-card .tip').textContent")
    assert float(led.split(" s")[0]) < early and page.text("state") == "stopped"  # and it drove nothing
    assert 8 < early < 10 < late and page.js("return Number(document.getElementById('scroll').max)") >= late


AXIS = """
const done = arguments[0];
import("/charts.js").then(({ Charts }) => {
  const canvas = document.createElement("canvas"), drawn = [];
  Object.assign(canvas.style, { width: "800px", height: "300px" });
  document.body.append(canvas);
  const charts = new Charts(canvas, () => {}, () => {}, () => "why");
  [0, 12, -12].forEach((af, k) => charts.note({ time: k, number: k, af, ar: 0, v: 108, took: 5, free: 500 }));
  const pen = canvas.getContext("2d"), text = pen.fillText.bind(pen);
  pen.fillText = (what, x, y) => { drawn.push([what, x, y]); text(what, x, y); };
  charts.draw();
  canvas.remove();
  done(drawn);
});
"""


def test_twelve_degrees_are_seen(page):
    labels = {text: y for text, x, y in page.browser.execute_async_script(AXIS) if x < 95}
    assert labels["-12"] - labels["12"] > 50 and {"steering", "speed", "decision", "free way"} <= set(labels)


def test_a_wrong_value_is_marked_with_its_range_and_a_change_undone(page):
    page.tab("tune")
    assert page.until(lambda: page.browser.find_elements("id", "parameter-drive.cruise"))
    assert "none of" in page.text("differ")
    write = "const one = document.getElementById('parameter-drive.cruise'); one.value = arguments[0]; one.dispatchEvent(new Event('input'))"
    row = "return document.getElementById('parameter-drive.cruise').closest('.parameter').innerText"
    page.js(write, 300)
    assert "91 to 180" in page.js(row) and page.js("return document.getElementById('parameter-drive.cruise').getAttribute('aria-invalid')") == "true"
    page.js(write, 120)
    assert "91 to 180" not in page.js(row).split("default")[-1]
    assert page.until(lambda: page.js("return told.findLast((one) => one.key === 'drive.cruise')?.value") == 120)
    assert "1 of" in page.text("differ")
    page.click("undo")
    assert page.until(lambda: page.js("return told.findLast((one) => one.key === 'drive.cruise')?.value") == 108)
    assert page.until(lambda: "none of" in page.text("differ"))
    assert page.js("return document.getElementById('parameter-drive.cruise').value") == "108"


def test_the_wheel_that_is_trimmed_is_drawn_turned(page):
    page.tab("tune")
    page.js("document.getElementById('trims').parentNode.open = true")
    page.js("const one = document.getElementById('parameter-servos.trims.3'); one.focus(); one.value = 7; one.dispatchEvent(new Event('input'))")
    wheels = page.js("return [...document.querySelectorAll('#trims .wheel')].map((one) => [one.getAttribute('transform'), one.classList.contains('marked')])")
    assert (
        len(wheels) == 10 and wheels[3] == ["rotate(7)", True] and all(turn in (None, "rotate(0)") and not marked for turn, marked in wheels[:3] + wheels[4:])
    )
    page.click("undo")
    assert page.until(lambda: page.js("return document.querySelectorAll('#trims .wheel')[3].getAttribute('transform')") == "rotate(0)")


@pytest.mark.parametrize(
    "pad",
    (
        "{id: 'motion sensors, gravity on an axis', axes: [0.02, -0.98], buttons: []}",
        "{id: 'wheel, pedals at rest', axes: [0, 1], buttons: []}",
        "{id: 'start held since before the page', axes: [0, 0], buttons: Array.from({length: 10}, (_, k) => ({pressed: k === 9}))}",
    ),
)
def test_a_pad_that_nobody_touches_drives_nothing(page, pad):
    page.click("stop")
    assert page.until(lambda: page.text("state") == "stopped")
    page.browser.execute_script(f'Object.defineProperty(navigator, "getGamepads", {{value: () => [{pad}], configurable: true}})')
    assert not page.until(lambda: page.text("state") != "stopped", 2)
    page.js("Object.defineProperty(navigator, 'getGamepads', {value: () => [], configurable: true})")


def test_the_buttons_of_a_pad_are_shown_and_learned(page):
    pad = """window.pad = {id: "odd pad", axes: [0, 0, 0], buttons: Array.from({length: 12}, () => ({pressed: false}))};
        Object.defineProperty(navigator, "getGamepads", {value: () => [window.pad], configurable: true})"""
    page.js(pad)
    page.tab("gamepad")
    uses = "return [...document.querySelectorAll('.use')].map((one) => one.firstChild.textContent)"
    assert page.until(lambda: page.js(uses) and page.js(uses)[:3] == ["steer: axis 0", "drive: axis 1, reversed", "stop: button 0 or 1"])
    page.click("auto")
    assert page.until(lambda: page.text("state") == "auto")
    time.sleep(0.8)  # the pad is seen at rest
    learn = "document.querySelectorAll('.use')[arguments[0]].querySelector('button').click()"
    page.js(learn, 2)
    page.js("window.pad.buttons[7].pressed = true")
    assert page.until(lambda: page.js(uses)[2] == "stop: button 7")
    assert page.text("state") != "stopped"  # showing it was no command
    page.js("window.pad.buttons[7].pressed = false")
    time.sleep(0.3)
    page.js("window.pad.buttons[7].pressed = true")
    assert page.until(lambda: page.text("state") == "stopped")
    page.click("auto")
    assert page.until(lambda: page.text("state") == "auto")
    page.js(learn, 5)
    time.sleep(0.2)
    page.js("window.pad.buttons[7].pressed = false")
    time.sleep(0.2)
    page.js("window.pad.buttons[7].pressed = true")
    assert page.until(lambda: page.js(uses)[5] == "next mode: button 7")
    assert not page.until(lambda: page.text("state") == "stopped", 0.5)
    page.click("stop")
    page.js(learn, 1)
    page.js("window.pad.axes[2] = -0.9")
    assert page.until(lambda: page.js(uses)[1] == "drive: axis 2, reversed")
    page.js("window.pad.axes[2] = 0; navigator.getGamepads = () => []")
    assert "odd pad" in page.js("return localStorage.getItem('gapseeker.pads')")


GEOMETRY = """
const done = arguments[arguments.length - 1], [cases] = arguments;
import("/geometry.js").then((g) => {
  const body = g.bodyOf({});
  done(cases.map(([af, ar]) => {
    const t = g.twist(body, af, ar);
    const angles = g.wheels(body).map((p) => Math.atan2(t.vx + t.w * p.y, t.vy - t.w * p.x) * 180 / Math.PI);
    // The way in closed form against ten thousand small steps.
    let at = { x: 0, y: 0, heading: 0 };
    for (let i = 0; i < 10000; i++) {
      const s = Math.sin(at.heading), c = Math.cos(at.heading), d = 0.07;
      at = { x: at.x + (t.vx * c + t.vy * s) * d, y: at.y + (t.vy * c - t.vx * s) * d, heading: at.heading + t.w * d };
    }
    const end = g.pose(t, 700);
    return { angles, error: Math.hypot(end.x - at.x, end.y - at.y), turn: Math.abs(end.heading - at.heading) };
  }));
});
"""


def test_the_page_s_geometry_is_the_robot_s(page):
    """Wheel angles against the firmware's steering; swept ways against small steps."""
    from core.axles import lay_out
    from link import protocol  # noqa: F401  makes sure that the firmware's modules can be imported
    from steering import Steering

    steering = Steering(lay_out([115, 150, 117, 115], 230, 248.5))
    cases = [(60, -60), (-30, 12), (0, -40), (35, 0), (50, 50), (25, 10), (90, -90)]
    found = page.browser.execute_async_script(GEOMETRY, cases)
    for (af, ar), one in zip(cases, found, strict=True):
        assert steering.solve(af * 10, ar * 10)
        for k, angle in enumerate(one["angles"]):
            # A wheel that would turn by more than 90 degrees is turned the other way round and reversed.
            apart = (angle - steering.angles[k] / 10 + 90) % 180 - 90
            assert abs(apart) < 0.15, (af, ar, k)
        assert one["error"] < 0.5 and one["turn"] < 1e-3
    assert found[0]["angles"][0] == pytest.approx(43.87, abs=0.01) and found[0]["angles"][1] == pytest.approx(83.46, abs=0.01)


MOTION = """
const done = arguments[arguments.length - 1], wrap = 2 ** 30 / 1e6;
import("/motion.js").then(({ Motion }) => {
  const motion = new Motion();
  const before = motion.from(5)(3, 4);
  motion.note({ time: wrap - 0.5, x: 0, y: 0, heading: 350 });
  motion.note({ time: 0.5, x: 100, y: 200, heading: 90 });
  done([before, motion.from(wrap - 0.5)(0, 1000), motion.from(0)(0, 0), motion.from(0.5)(7, 8), motion.from(wrap - 5)(1, 2)]);
});
"""


def test_what_was_seen_moves_with_the_robot(page):
    found = [(round(one["x"]), round(one["y"])) for one in page.browser.execute_async_script(MOTION)]
    # Nothing known, seen across the clock's wrap, half way between two poses, just now, too long ago.
    assert found == [(3, 4), (-785, -274), (100, -50), (7, 8), (1, 2)]


GOAL = """
const done = arguments[0];
import("/goal.js").then(({ goal }) => {
  const sent = [], send = goal.page.send, message = (state, alarm) => ({
    type: "goal", state, alarm, method: "gap", pose_state: "known", x: 1000, y: 2000, heading: 90, error: 12, fits: 88, goal: [3000, 2000], steer: [2000, 2000],
    length: 7.5, door: 0, through: null, open: 600, middle: 0, searches: 1, waiting: 0, patrol: false });
  goal.page.send = (command) => sent.push(command);
  goal.page.state.truth = { x: 500, y: 600, heading: 0 };
  goal.hear.map({ rows: 2, cols: 2, cell: 300, origin: [0, 0], doors: [{ x: 300, y: 300, normal: 0, width: 900 }] });
  goal.hear.cells({ first: 2, cells: [0xffff, 0x8000] });
  goal.hear.goal(message("alarm", "door shut"));
  // The robot looks to the right on its map, and up where it is drawn: what lies ahead of it is up.
  const ahead = goal.drawn(2000, 2000), back = goal.mapped(ahead.x, ahead.y);
  goal.press({ x: 500, y: 1600 });
  document.querySelector("#panel-goal [data-id=give-up]").click();
  const told = document.querySelector("#panel-goal dl").innerText || document.querySelector("#panel-goal dl").textContent;
  const bad = [...document.querySelectorAll("#panel-goal dd.bad")].map((one) => one.textContent), shown = goal.shown();
  goal.page.send = send;
  goal.hear.connected();
  done({ ahead, back, sent, told, bad, shown, gone: goal.shown() });
});
"""


def test_a_robot_with_a_map_is_sent_by_a_click_and_its_alarm_is_told(page):
    found = page.browser.execute_async_script(GOAL)
    assert (round(found["ahead"]["x"]), round(found["ahead"]["y"])) == (500, 1600)
    assert (round(found["back"]["x"]), round(found["back"]["y"])) == (2000, 2000)
    assert found["sent"] == [{"do": "go", "what": "there", "x": 2000, "y": 2000, "heading": 90}, {"do": "go", "what": "give up"}]
    assert found["bad"] == ["alarm: door shut"] and "within 12 mm, 88 % of the points fit" in found["told"]
    assert found["shown"] and not found["gone"]


def test_a_course_is_chosen_by_its_picture_with_what_fails(page):
    page.tab("twin")
    pictures = page.js(
        "return [...document.querySelectorAll('.courses button')].map((one) => [one.textContent, one.querySelector('path').getAttribute('d').length])"
    )
    assert {"Z", "U", "S", "S-sharp", "bend", "random"} <= {name for name, _ in pictures} and all(long > 60 for _, long in pictures)
    page.js("document.querySelector('.courses [data-value=u]').click()")
    page.js(
        "for (const [id, value] of [['size', 700], ['seed', 2], ['fault', 'lidar-frozen'], ['after', 9]]) document.querySelector(`#panel-twin [data-id=${id}]`).value = value"
    )
    page.js("document.querySelector('#panel-twin [data-id=form] button.main').click()")
    assert page.until(lambda: page.text("address") == "twin:U?scale=2&width=700&seed=2&fault=lidar-frozen%409"), page.text("address")
    page.js(
        "document.querySelector('#panel-twin [data-id=size]').value = 20; document.querySelector('#panel-twin [data-id=form]').noValidate = true; document.querySelector('#panel-twin [data-id=form] button.main').click()"
    )
    assert page.until(lambda: "260 to 3000" in page.js("return document.querySelector('#panel-twin [data-id=trouble]').textContent"))
