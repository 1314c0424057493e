"""The robot's screen on the page, in a real browser: it is live, and a click on it is a touch."""

import time

import pytest
from open_page import Monitor, needs_browser

pytestmark = needs_browser

GLASS = "document.querySelector('#panel-screen input')"
# The colour of a pixel of what is shown, drawn anew.
PIXEL = f"""
const [x, y, done] = arguments, image = new Image();
image.onload = () => {{
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [image.width, image.height];
  const pen = canvas.getContext("2d");
  pen.drawImage(image, 0, 0);
  done([...pen.getImageData(x, y, 1, 1).data].slice(0, 3));
}};
image.src = {GLASS}.src;
"""


@pytest.fixture
def page(browser):
    page = Monitor(browser, "twin:z?width=620&screen=usart-gpu&autostart=0")
    page.size(1440, 900)
    yield page
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    page.close()


def wait(what, limit_s=60):
    end = time.monotonic() + limit_s
    while not (found := what()):
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.1)
    return found


def test_a_click_on_the_screen_starts_the_robot_and_another_stops_it(page):
    wait(lambda: page.js(f"return {GLASS}?.src.length > 100 && !document.getElementById('tab-screen').hidden"))
    page.js("document.getElementById('tab-screen').click()")
    pixel = lambda x, y: page.browser.execute_async_script(PIXEL, x, y)  # noqa: E731
    wait(lambda: pixel(10, 262)[0] > 200)  # the red of its button: stop
    wait(lambda: "waiting" in page.js("return document.body.innerText").lower())

    def click(x, y):
        script = f"const [x, y] = arguments, glass = {GLASS}, box = glass.getBoundingClientRect();"
        script += "glass.dispatchEvent(new MouseEvent('click', {detail: 1, bubbles: true, clientX: box.x + x / 240 * box.width, clientY: box.y + y / 320 * box.height}))"
        page.js(script, x, y)

    click(120, 290)
    wait(lambda: "auto" in page.text("state").lower())
    click(40, 290)
    wait(lambda: "stop" in page.text("state").lower())
