# SPDX-License-Identifier: Apache-2.0
"""The pages of --report, in a browser: they render, the slider moves, nothing is fetched.

Arguments: the program. Needs Debian's chromium, chromium-driver and python3-selenium; exits 77, a
skip, where one is missing.
"""

import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PHONE = (390, 844)
DESKTOP = (1280, 900)


def missing_tools() -> list[str]:
    missing = [name for name in ("chromium", "chromedriver") if shutil.which(name) is None]
    if importlib.util.find_spec("selenium") is None:
        missing.append("python3-selenium")
    return missing


def open_browser():
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    for argument in ("--headless=new", "--disable-gpu", "--disable-dev-shm-usage"):
        options.add_argument(argument)
    if os.geteuid() == 0:
        options.add_argument("--no-sandbox")  # Chromium's refuses to run as root
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)


class ReportPage(unittest.TestCase):
    program = ""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        root = Path(cls.folder.name)
        run = lambda *arguments: subprocess.run(
            [cls.program, *map(str, arguments), "--progress", "none"],
            cwd=root, check=True, stdin=subprocess.DEVNULL, capture_output=True)
        run("simulate", "clip", "--motion", "vibration", "--duration", "0.7", 
            "--width", "320", "--height", "180")
        # What file names may hold.
        clip = root / "<script>document.title='owned'<img src=x>.mp4"
        shutil.copy(root / "clip" / "rs.mp4", clip)
        run(clip, "-o", "steady.mp4", "--rs", "gyro", "--gyro", "clip/gyro.csv",
            "--camera", "clip/camera.json", "--report", "steady.html")
        run("compare", clip, "steady.mp4", "--truth", "clip", "--report", "compare.html")
        run("evaluate", "--clips", "clip", "--methods", "input,off,gyro,fused",
            "--report", "evaluate.html")
        cls.clip_pages = [root / "steady.html", root / "compare.html"]
        cls.pages = [*cls.clip_pages, root / "evaluate.html"]
        cls.browser = open_browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.quit()
        cls.folder.cleanup()

    def show(self, page: Path, size, scheme: str):
        self.browser.execute_cdp_cmd(
            "Emulation.setEmulatedMedia",
            {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
        self.browser.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": size[0], "height": size[1], "deviceScaleFactor": 1,
             "mobile": size is PHONE})
        self.browser.get(page.as_uri())

    def script(self, text: str, *arguments):
        return self.browser.execute_script("return " + text, *arguments)

    def test_renders_without_an_error(self):
        for page in self.pages:
            for size in (PHONE, DESKTOP):
                with self.subTest(page=page.name, size=size):
                    self.show(page, size, "light")
                    # Nothing sticks out: a phone shows the page without scrolling sideways.
                    self.assertLessEqual(self.script("document.documentElement.scrollWidth"),
                                         size[0])
                    self.assertTrue(self.script(
                        "[...document.images].every(i => i.complete && i.naturalWidth > 0)"))
                    self.assertGreaterEqual(self.script("document.images.length"), 6)
                    self.assertGreaterEqual(
                        self.script("document.querySelectorAll('svg.chart path.line').length"), 8)
                    self.assertEqual(self.browser.get_log("browser"), [])

    def test_light_and_dark(self):
        background = "getComputedStyle(document.body).backgroundColor"
        for page in self.pages:
            self.show(page, PHONE, "light")
            self.assertEqual(self.script(background), "rgb(255, 255, 255)")
            self.show(page, PHONE, "dark")
            channels = [int(n) for n in re.findall(r"\d+", self.script(background))]
            self.assertLess(max(channels), 60)

    def test_slider_moves(self):
        from selenium.webdriver.common.action_chains import ActionChains
        from selenium.webdriver.common.keys import Keys

        self.show(self.pages[0], DESKTOP, "light")
        stage = self.browser.find_element("css selector", ".stage")
        over = stage.find_element("css selector", ".over")
        shown = lambda: float(re.search(
            r"([\d.]+)%", self.script("arguments[0].style.getPropertyValue('--split')", stage))[1])
        hidden_px = lambda: self.script(
            "arguments[0].getBoundingClientRect().width"
            " * (100 - parseFloat(arguments[0].parentNode.style.getPropertyValue('--split')))"
            " / 100", over)
        self.assertEqual(shown(), 50.0)
        quarter = stage.size["width"] / 4
        ActionChains(self.browser).move_to_element(stage).click_and_hold().move_by_offset(
            quarter, 0).release().perform()
        self.assertAlmostEqual(shown(), 75.0, delta=1.0)
        self.assertAlmostEqual(hidden_px(), quarter, delta=6.0)
        # Keys, for those without a pointer: the slider has the focus now.
        before = shown()
        stage.find_element("css selector", "input").send_keys(Keys.ARROW_LEFT * 4)
        self.assertAlmostEqual(shown(), before - 2.0, delta=0.1)

    def test_methods_stand_beside_the_truth(self):
        self.show(self.pages[2], DESKTOP, "light")
        galleries = self.script("[...document.querySelectorAll('.gallery')].map("
                                "g => [...g.querySelectorAll('figcaption b')]"
                                ".map(b => b.textContent))")
        methods = ["input", "off", "gyro", "fused"]
        self.assertEqual(galleries, [methods + ["truth"], methods])
        # How bright the maps are: the closer to the truth, the darker.
        level = lambda n: self.script(
            "(i => { const c = document.createElement('canvas');"
            " c.width = i.naturalWidth; c.height = i.naturalHeight;"
            " const g = c.getContext('2d'); g.drawImage(i, 0, 0);"
            " const d = g.getImageData(0, 0, c.width, c.height).data;"
            " return d.reduce((sum, v) => sum + v, 0) / d.length; })"
            f"(document.querySelectorAll('.gallery')[1].querySelectorAll('img')[{n}])")
        self.assertLess(level(methods.index("gyro")), level(methods.index("input")))

    def test_nothing_is_fetched(self):
        for page in self.pages:
            self.browser.get_log("performance")
            self.show(page, DESKTOP, "light")
            requested = []
            for entry in self.browser.get_log("performance"):
                message = json.loads(entry["message"])["message"]
                if message["method"] == "Network.requestWillBeSent":
                    requested.append(message["params"]["request"]["url"])
            elsewhere = [url[:80] for url in requested
                         if not url.startswith("data:") and url != page.as_uri()]
            self.assertEqual(elsewhere, [])
            text = page.read_text(encoding="utf-8")
            self.assertIsNone(re.search(r"""(src|href)\s*=\s*["']?\s*(https?:|//|file:)""", text))
            self.assertIn("default-src 'none'", text)

    def test_names_stay_text(self):
        for page in self.clip_pages:
            self.show(page, DESKTOP, "light")
            heading = self.script("document.querySelector('h1').textContent")
            self.assertEqual(heading, "<script>document.title='owned'<img src=x>.mp4")
            self.assertEqual(self.script("document.title"), heading)
            self.assertEqual(self.script("document.scripts.length"), 1)

    def test_foreign_script_would_not_run(self):
        # Even if something slipped through, the page's policy stops it.
        page = Path(self.folder.name) / "altered.html"
        text = self.pages[0].read_text(encoding="utf-8")
        page.write_text(text.replace("<footer>", "<script>document.title='owned'</script><footer>"),
                        encoding="utf-8")
        self.show(page, DESKTOP, "light")
        self.assertNotEqual(self.script("document.title"), "owned")
        self.assertTrue(any("Content Security Policy" in entry["message"]
                            for entry in self.browser.get_log("browser")))


if __name__ == "__main__":
    missing = missing_tools()
    if missing:
        print(f"skipped: there is no {', '.join(missing)}")
        sys.exit(77)
    ReportPage.program = str(Path(sys.argv.pop(1)).resolve())
    unittest.main(verbosity=2)
