"""How the monitor's page looks in a real browser, at the sizes of phones, tablets and screens, light and dark."""

import pytest
from open_page import Monitor, needs_browser

pytestmark = needs_browser
SIZES = [(390, 844), (844, 390), (768, 1024), (1024, 768), (1440, 900), (1920, 1080)]
TABS = "return [...document.querySelectorAll('#tabs button')].filter((one) => !one.hidden).map((one) => one.id.slice(4))"


@pytest.fixture(scope="module")
def page(browser):
    page = Monitor(browser, "twin:random?gap=700")
    page.size(1440, 900)
    page.theme("dark")
    assert page.until(lambda: page.speeds() and max(page.speeds()) > 50)
    yield page
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    page.close()


JUMPS = """
const done = arguments[0], places = new Map(), moved = new Set(), end = performance.now() + 2500;
const name = (one) => one.id || one.className || one.tagName;
const look = () => {
  for (const one of document.querySelectorAll("header *, main h2, main canvas, .card, .card button, .figures b, #dials output, #dials svg")) {
    const { x, y, width, height } = one.getBoundingClientRect();
    const now = [x, y, width, height].map(Math.round).join();
    if (places.has(one) && places.get(one) !== now && one.id !== "reason") moved.add(`${name(one)} of ${name(one.parentNode)}`);
    places.set(one, now);
  }
  performance.now() < end ? requestAnimationFrame(look) : done([...moved]);
};
look();
"""


def test_nothing_moves_while_the_digits_change(page):
    figures = page.text("numbers") + page.text("place")
    assert page.browser.execute_async_script(JUMPS) == []
    assert page.text("numbers") + page.text("place") != figures  # or nothing was seen
    page.click("stop")
    assert page.until(lambda: page.text("state") == "stopped")


LAYOUT = """
const cards = [...document.querySelectorAll("main .card")].filter((one) => one.offsetParent).map((one) => ({ id: one.id, ...one.getBoundingClientRect().toJSON() }));
return { wide: document.documentElement.scrollWidth, view: innerWidth, high: innerHeight, scroll: document.documentElement.scrollHeight, cards,
  stop: document.getElementById("stop").getBoundingClientRect().toJSON(), heads: ["", "a", "part of the program hung and was restarted: see the log, and so on"].map((text) => {
    document.getElementById("reason").textContent = text;
    return document.querySelector("header").offsetHeight;
  }) };
"""


@pytest.mark.parametrize("size", SIZES, ids=lambda size: f"{size[0]}x{size[1]}")
def test_it_fits_and_leaves_no_holes(page, size):
    page.size(*size)
    found = page.js(LAYOUT)
    cards, stop = found["cards"], found["stop"]
    assert len(set(found["heads"])) == 1  # whatever is said, what stands below does not move
    assert found["wide"] <= found["view"]
    assert stop["top"] >= 0 and stop["bottom"] <= size[1] and stop["right"] <= size[0] and stop["width"] >= 100
    assert stop["height"] >= (44 if size[0] < 700 or size[1] < 560 else 30)
    # Cards beside each other begin and end together, and each row reaches from side to side.
    right = max(card["right"] for card in cards)
    for card in cards:
        for other in cards:
            assert (
                card is other
                or card["right"] <= other["left"]
                or other["right"] <= card["left"]
                or card["bottom"] <= other["top"]
                or other["bottom"] <= card["top"]
            )
    covered = sum(card["width"] * card["height"] for card in cards)
    top, bottom, left = min(c["top"] for c in cards), max(c["bottom"] for c in cards), min(c["left"] for c in cards)
    assert covered > 0.93 * (right - left) * (bottom - top), {card["id"]: [round(card[k]) for k in ("left", "top", "right", "bottom")] for card in cards}
    if size[0] >= 1000:
        assert found["scroll"] <= size[1]


def test_on_a_phone_the_stick_lies_over_the_map_and_stop_under_the_thumb(page):
    for size in ((390, 844), (844, 390)):
        page.size(*size)
        page.js("scrollTo(0, 0)")
        assert not page.browser.find_element("id", "stick").is_displayed()
        page.browser.find_element("id", "manual").click()
        page.frames(2)
        boxes = "return ['stick', 'map', 'stop'].map((id) => document.getElementById(id).getBoundingClientRect().toJSON())"
        stick, map_, stop = page.js(boxes)
        assert stick["width"] >= 120 and stick["left"] < map_["right"] and stick["top"] < map_["bottom"] and stick["bottom"] > map_["top"]
        assert 0 <= stick["left"] and stick["right"] <= size[0] and stick["bottom"] <= size[1]
        assert stick["bottom"] <= stop["top"] or stick["right"] <= stop["left"]
        hit = "const { x, y, width, height } = document.getElementById('stick').getBoundingClientRect(); return document.elementFromPoint(x + width / 2, y + height / 2).closest('#stick') !== null"
        assert page.js(hit)
        page.keep_screenshot(f"monitor-{'phone' if size[0] < size[1] else 'landscape'}.png")
        page.browser.find_element("id", "stop").click()
        assert page.until(lambda: page.text("state") == "stopped")


CONTRAST = """
const shade = ([r, g, b]) => {
  const [x, y, z] = [r, g, b].map((v) => (v / 255 <= 0.03928 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4));
  return 0.2126 * x + 0.7152 * y + 0.0722 * z;
};
const parse = (text) => text.match(/[\\d.]+/g).map(Number);
const ground = (one) => {
  for (; one; one = one.parentElement) {
    const colour = parse(getComputedStyle(one).backgroundColor);
    if (colour.length < 4 || colour[3] > 0.5) return colour;
  }
  return [255, 255, 255];
};
const bad = [];
const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
while (walker.nextNode()) {
  const one = walker.currentNode.parentElement;
  if (!walker.currentNode.data.trim() || !one.offsetParent || one.closest(":disabled, script, option")) continue;
  const style = getComputedStyle(one), a = shade(parse(style.color)), b = shade(ground(one));
  const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
  if (style.visibility === "visible" && ratio < 4.5) bad.push(`${walker.currentNode.data.trim()}: ${ratio.toFixed(1)}`);
}
return bad;
"""

DRAWN = """
const shade = (text) => {
  const [r, g, b] = [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16) / 255).map((v) => (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const style = getComputedStyle(document.documentElement), of = (name) => shade(style.getPropertyValue(`--${name}`).trim()), well = of("well");
return ["green", "red", "blue", "yellow", "chosen", "refused", "other", "wall", "edge", "faint"].filter((name) => {
  const one = of(name);
  return (Math.max(one, well) + 0.05) / (Math.min(one, well) + 0.05) < 3;
});
"""


@pytest.mark.parametrize("theme", ("dark", "light"))
def test_contrast_is_enough_to_read(page, theme):
    """WCAG 2, AA: 4.5 for text, 3 for what is drawn."""
    page.size(1440, 900)
    page.theme(theme)
    ground = page.js("return getComputedStyle(document.body).backgroundColor")
    assert (min(int(v) for v in ground[4:-1].split(",")) > 128) == (theme == "light")
    page.js(
        "document.querySelectorAll('details').forEach((one) => { one.open = true }); if (document.getElementById('legend-box').hidden) document.getElementById('legend').click()"
    )
    for tab in page.js(TABS):
        page.tab(tab)
        assert page.js(CONTRAST) == [], tab
    page.js("document.getElementById('legend').click()")
    assert page.js(DRAWN) == []


REACH = """
const names = [];
for (const one of document.querySelectorAll("button, input, select, a[href], summary, canvas[tabindex], [role=tab], #stick, meter, svg")) {
  if (!one.offsetParent && one.tagName !== "svg") continue;
  if (one.tagName === "svg") {
    if (!one.closest("[aria-hidden]") && !one.closest("[aria-label]") && one.checkVisibility() && !one.getAttribute("aria-label")) names.push("svg of " + one.parentNode.className);
    continue;
  }
  const label = one.getAttribute("aria-label") || one.labels?.[0]?.textContent || one.textContent || one.title;
  if (!label.trim()) names.push(one.outerHTML.slice(0, 80));
  if (one.tagName !== "METER" && one.tabIndex < 0 && one.getAttribute("role") !== "tab") names.push("not reached: " + one.outerHTML.slice(0, 80));
  if (one.getAttribute("type") === "checkbox") names.push("a tick box, which the space bar cannot turn: " + one.outerHTML.slice(0, 80));
}
return names;
"""


def test_keyboard_and_screen_reader_reach_everything(page):
    from selenium.webdriver.common.keys import Keys

    page.size(1440, 900)
    for tab in page.js(TABS):
        page.tab(tab)
        assert page.js(REACH) == [], tab
    assert {"wheels", "health", "tune", "record", "twin", "gamepad"} <= set(page.js(TABS))
    # Arrows go from tab to tab, and drive nothing then.
    first = page.browser.find_element("id", "tab-wheels")
    page.js("arguments[0].focus()", first)
    page.tab("wheels")
    first.send_keys(Keys.ARROW_RIGHT)
    assert page.js("return document.activeElement.id") == "tab-health" and page.browser.find_element("id", "panel-health").is_displayed()
    assert page.text("state") == "stopped"
    # Enter turns what the space bar, which stops, does not.
    ages = page.browser.find_element("id", "ages")
    ages.send_keys(Keys.ENTER)
    assert ages.get_attribute("aria-pressed") == "true"
    ages.send_keys(Keys.SPACE)
    assert ages.get_attribute("aria-pressed") == "true"


WINDOWS = """
const done = arguments[0];
import("/marks.js").then(({ mark }) => {
  const shapes = [0, 1, 2, 3, 4].map((window) => {
    const canvas = Object.assign(document.createElement("canvas"), { width: 24, height: 24 }), pen = canvas.getContext("2d");
    mark(pen, 12, 12, 2, window);
    // Where there is ink, whatever its colour.
    return pen.getImageData(0, 0, 24, 24).data.filter((_, k) => k % 4 === 3).map((a) => (a > 100 ? 1 : 0)).join("");
  });
  done(shapes);
});
"""


def test_windows_are_told_apart_without_colour(page):
    shapes = page.browser.execute_async_script(WINDOWS)
    for k, one in enumerate(shapes):
        for other in shapes[k + 1 :]:
            assert sum(a != b for a, b in zip(one, other)) > 0.2 * max(one.count("1"), other.count("1"))
