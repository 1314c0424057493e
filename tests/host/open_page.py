"""The monitor's page opened in Debian's Chromium, headless: what the tests of the page share.

Needs chromium and chromium-driver; without them these tests are left out, and say so. With SCREENSHOTS=FOLDER in the environment the pictures of the page
are kept there (`make screenshots` puts them into docs/).
"""

import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BROWSER, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
needs_browser = pytest.mark.skipif(
    not (BROWSER and DRIVER), reason="left out: the monitor's page in a real browser; to get it: apt install chromium chromium-driver"
)
FLAGS = (
    "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--disable-background-networking", "--disable-component-update",
    "--disable-sync", "--no-first-run", "--hide-scrollbars",
)  # fmt: skip
NUMBER = re.compile(r"-?\d+")


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    webdriver = pytest.importorskip("selenium.webdriver")
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = BROWSER
    for flag in (*FLAGS, "--window-size=1500,1420", f"--user-data-dir={tmp_path_factory.mktemp('browser')}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(DRIVER))
    yield driver
    driver.quit()


class Monitor:
    """A monitor in a process of its own, as a person starts it, with its page open."""

    def __init__(self, browser, address, *options):
        self.process = subprocess.Popen([sys.executable, "-m", "host.monitor", address, "--no-browser", *options], stdout=subprocess.PIPE, text=True, cwd=ROOT)
        self.url = self.process.stdout.readline().split()[-1]
        self.browser = browser
        browser.get(self.url)

    def close(self):
        problems = [entry["message"] for entry in self.browser.get_log("browser") if entry["level"] == "SEVERE"]
        self.browser.get("about:blank")
        self.process.terminate()
        self.process.wait(10)
        assert problems == []

    def text(self, name):
        return self.browser.find_element("id", name).text

    def click(self, name):
        element = self.browser.find_element("id", name)
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", element)
        element.click()

    def size(self, width, height):
        """As on a screen of this size; a phone's where it is small."""
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 900})
        self.frames(2)

    def theme(self, name):
        """light or dark."""
        self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": name}]})
        self.frames(2)

    def frames(self, count):
        """Let the browser draw so often."""
        script = "const done = arguments[1]; let left = arguments[0]; const next = () => (left-- > 0 ? requestAnimationFrame(next) : done()); next()"
        self.browser.execute_async_script(script, count)

    def js(self, script, *arguments):
        return self.browser.execute_script(script, *arguments)

    def tab(self, name):
        """Open one of the panels."""
        self.click(f"tab-{name}")

    def until(self, condition, seconds=60.0):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if condition():
                return True
            time.sleep(0.05)
        return False

    def speeds(self):
        """mm/s of each wheel, as the dials say."""
        texts = self.browser.execute_script("return [...document.querySelectorAll('#dials output')].map((one) => one.textContent)")
        return [int(text.split()[-2]) for text in texts]

    def place(self):
        """x, y (mm) and heading of the robot, as the page says."""
        return tuple(int(number) for number in NUMBER.findall(self.text("place"))[:3])

    def picture(self, name):
        """Fingerprint of what is drawn on a canvas."""
        return self.browser.execute_script("return document.getElementById(arguments[0]).toDataURL()", name)

    def colours(self, name):
        """How many different colours are on a canvas."""
        script = """const canvas = document.getElementById(arguments[0]);
            const data = new Uint32Array(canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.buffer);
            return new Set(data).size"""
        return self.browser.execute_script(script, name)

    def press(self, key, kind="keydown"):
        """A key event, as when it is held: selenium can only press and let go."""
        script = "document.body.dispatchEvent(new KeyboardEvent(arguments[1], {code: arguments[0], bubbles: true, cancelable: true}))"
        self.browser.execute_script(script, key, kind)

    def keep_screenshot(self, name):
        folder = os.environ.get("SCREENSHOTS")
        if folder:
            self.browser.execute_script("scrollTo(0, 0)")
            Path(folder).mkdir(parents=True, exist_ok=True)
            self.browser.save_screenshot(str(Path(folder) / name))


@pytest.fixture
def monitor(browser):
    """Callable that starts a monitor; all are closed at the end."""
    started = []

    def start(*arguments):
        started.append(Monitor(browser, *arguments))
        return started[-1]

    yield start
    for one in started:
        one.close()
