"""Tests the page for the browser (./dev web), opened from disk: its diagnosis is the program's, its curves follow the sliders.

    web_page.py IQFOC PAGE.html [FOLDER for pictures]"""

import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import unittest

import browser

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM, PAGE = (pathlib.Path(path).resolve() for path in sys.argv[1:3])
PICTURES = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else None
RECORDINGS = [path.name[:-len(".csv.gz")] for path in sorted((ROOT / "data" / "recordings").glob("*.csv.gz"))]


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.browser = browser.Browser(1200, 900)
        cls.browser.open(PAGE)

    @classmethod
    def tearDownClass(cls):
        cls.browser.__exit__()
        cls.temporary.cleanup()

    def tearDown(self):
        self.assertEqual(self.browser.console(), [])

    def idle(self, seconds=120):
        """Until the page has answered all that it was asked."""
        end = time.monotonic() + seconds
        while self.browser.run("return window.iqfoc.busy") != 0:
            self.assertLess(time.monotonic(), end, "the page does not come to an end")
            time.sleep(0.05)

    def picture(self, name):
        if PICTURES is not None:
            PICTURES.mkdir(parents=True, exist_ok=True)
            self.browser.picture(PICTURES / name, whole=True)

    def window_picture(self, name, file):
        """Of the window, scrolled to an element: a picture of the whole page leaves frames outside the window blank."""
        self.browser.run("document.getElementById(arguments[0]).scrollIntoView()", name)
        time.sleep(0.5)
        if PICTURES is not None:
            self.browser.picture(PICTURES / file)

    def give(self, *paths):
        """Chooses files, as the reader does by the button."""
        found = self.browser.call("/element", {"using": "css selector", "value": "#choose"})
        self.browser.call(f"/element/{next(iter(found.values()))}/value", {"text": "\n".join(str(path) for path in paths)})
        time.sleep(0.3)
        self.idle()

    def slide(self, name, value):
        before = self.browser.run("return window.iqfoc.draws")
        self.browser.run("const s = document.getElementById(arguments[0]); s.value = arguments[1]; s.dispatchEvent(new Event('input'));",
                         name, value)
        end = time.monotonic() + 120
        while self.browser.run("return window.iqfoc.draws") == before:
            self.assertLess(time.monotonic(), end, "the curves were not drawn again")
            time.sleep(0.05)
        self.idle()
        return self.browser.run("return window.iqfoc.last")

    def test_the_diagnosis_is_the_programs(self):
        for name in RECORDINGS:
            files = [ROOT / "data" / "recordings" / (name + ending) for ending in (".csv.gz", ".toml")]
            written = self.folder / "diagnosis.json"
            told = subprocess.run([PROGRAM, "diagnose", files[0].name, "--motor", files[1].name, "--json", written],
                                  cwd=files[0].parent, capture_output=True, text=True, check=True)
            self.browser.open(PAGE)
            self.give(*files)
            self.assertEqual(self.browser.run("return document.getElementById('state').className"), "note")
            mine = self.browser.run("return window.iqfoc.json")
            # Text with text: to the last digit of all 17.
            self.assertEqual(mine.splitlines(), written.read_text().splitlines())
            self.assertEqual(self.browser.run("return document.getElementById('words').textContent"), told.stdout)
            self.assertEqual(self.browser.run("return document.getElementById('verdict').textContent"), json.loads(mine)["verdict"])
        self.picture("diagnosis.png")

    def text(self, name):
        return self.browser.run("return document.getElementById(arguments[0]).textContent", name)

    def click(self, name):
        self.browser.run("document.getElementById(arguments[0]).click()", name)
        time.sleep(0.2)
        self.idle()

    def files(self, name="files"):
        """What the page made: {name: text}."""
        return self.browser.run("return Object.fromEntries(Object.entries(window.iqfoc[arguments[0]]).map("
                                "([n, b]) => [n, new TextDecoder().decode(b)]))", name)

    def same_files(self, mine, folder):
        """The program's, but for the command that was typed and the date."""
        self.assertEqual(sorted(mine), sorted(path.name for path in folder.iterdir()))
        for name, text in mine.items():
            both = [re.sub(r"Where this page comes from.*?</dl>", "", one, flags=re.S) for one in (text, (folder / name).read_text())]
            self.assertEqual(*(one.splitlines() for one in both), name)

    def test_the_example(self):
        """A button leads to verdict and report; its files are those of `iqfoc diagnose -o`, and those of the controller `iqfoc tune -o`."""
        self.browser.open(PAGE)
        self.idle()
        self.assertNotIn("http", self.browser.run("return [...document.querySelectorAll('[src],link')].map((e) => e.src || e.href).join()"))
        self.click("example")
        self.assertEqual(self.text("verdict"), "explained")
        self.assertIn("dead_time", self.text("causes"))
        told = self.folder / "example"
        folder = ROOT / "data/recordings"
        subprocess.run([PROGRAM, "diagnose", "dead_time.csv.gz", "--motor", "dead_time.toml", "-o", told], cwd=folder, capture_output=True,
                       check=True)
        # (The page unpacks the recording before it is read, so that its hash is another.)
        self.same_files(self.files(), told)
        self.assertFalse(self.browser.run("return document.getElementById('report').hidden"))
        self.assertTrue(self.browser.run("return document.getElementById('report').src").startswith("blob:"))
        frame = self.browser.call("/element", {"using": "css selector", "value": "#report"})
        self.browser.call("/frame", {"id": frame})
        drawn = self.browser.run("return document.querySelectorAll('canvas').length")
        self.browser.call("/frame", {"id": None})
        self.assertGreater(drawn, 8)
        self.picture("example.png")
        self.window_picture("report", "report.png")

        self.click("tune")
        self.assertEqual(self.text("tune-state"), "")
        given = self.folder / "diagnosis.json"
        given.write_text(self.browser.run("return window.iqfoc.json"))
        told = self.folder / "tuned"
        done = subprocess.run([PROGRAM, "tune", "--motor", folder / "dead_time.toml", "--diagnosis", given.name, "-o", told],
                              cwd=self.folder, capture_output=True, text=True, check=True)
        mine = self.files("tuned")
        self.assertEqual(mine["iqfoc_tuned.h"], (told / "iqfoc_tuned.h").read_text())
        self.assertEqual(sorted(mine), sorted(path.name for path in told.iterdir()))
        self.assertEqual(self.text("tuned"), done.stdout[:done.stdout.index("\nPage: ")])
        self.picture("tuned.png")
        self.browser.size(400, 900)
        self.picture("example_400.png")
        self.window_picture("report", "report_400.png")
        self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), 400)
        self.browser.size(1200, 900)

    def test_a_log_of_another_program(self):
        """The map is the one that `iqfoc import` proposes; corrected in the page it leads to the program's recording and diagnosis."""
        log, right = ROOT / "data/logs/bench.csv", (ROOT / "data/logs/bench_map.toml").read_text()
        motor = ROOT / "data/recordings/dead_time.toml"
        for name, text in (("bench.csv", log.read_bytes()), ("wide.csv", log.read_bytes().decode("latin-1").encode("utf-16"))):
            (self.folder / name).write_bytes(text)
            told = subprocess.run([PROGRAM, "import", name], cwd=self.folder, capture_output=True, text=True, check=True)
            self.browser.open(PAGE)
            self.give(self.folder / name)
            self.assertEqual(self.browser.run("return document.getElementById('map').value"), told.stdout)
        rows = self.browser.run("return [...document.querySelectorAll('#head tr')].map((r) => [...r.cells].map((c) => c.textContent))")
        first = [line.split(";") for line in log.read_text("latin-1").splitlines()[5:9]]
        self.assertIn(["i_q_A", "Iq", "mA", "  ".join(fields[3] for fields in first)], rows)

        self.click("convert")
        self.assertIn("motor file is missing", self.text("state"))
        self.give(motor)
        (self.folder / "map.toml").write_text(right)
        self.browser.run("const m = document.getElementById('map'); m.value = arguments[0]; m.dispatchEvent(new Event('input'))", right)
        self.picture("log.png")
        self.click("check-map")
        base = [PROGRAM, "import", "wide.csv", "--map", "map.toml", "--motor", motor]
        told = subprocess.run([*base, "--check"], cwd=self.folder, capture_output=True, text=True, check=True)
        self.assertEqual(self.text("checked"), told.stdout)
        self.click("convert")
        subprocess.run([*base, "-o", "recording.csv"], cwd=self.folder, capture_output=True, check=True)
        self.assertEqual(self.browser.run("return window.iqfoc.recording"), (self.folder / "recording.csv").read_text())
        (self.folder / motor.name).write_text(motor.read_text())
        for options in (("--json", "log.json"), ("-o", "log")):
            subprocess.run([PROGRAM, "diagnose", "recording.csv", "--motor", motor.name, *options], cwd=self.folder, capture_output=True,
                           check=True)
        self.assertEqual(self.browser.run("return window.iqfoc.json"), (self.folder / "log.json").read_text())
        self.same_files(self.files(), self.folder / "log")
        self.browser.size(400, 900)
        self.picture("log_400.png")
        self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), 400)
        self.browser.size(1200, 900)

    def test_a_map_that_cannot_be_used_is_named(self):
        self.browser.open(PAGE)
        self.give(ROOT / "data/logs/bench.csv", ROOT / "data/recordings/dead_time.toml")
        self.browser.run("document.getElementById('map').value = '[columns]\\ni_a_A = \"nothing\"\\n'")
        self.click("convert")
        self.assertTrue(self.text("state").startswith("iqfoc: map.toml: [columns] lacks the time"), self.text("state"))
        self.assertFalse(self.browser.run("return window.iqfoc.json"))

    def test_the_size_is_the_documented_one(self):
        stated = float(re.search(r"one file of ([\d.]+) MB", (ROOT / "docs/web.md").read_text(encoding="utf-8"))[1])
        self.assertAlmostEqual(PAGE.stat().st_size / 1e6, stated, delta=0.03 * stated)

    def test_a_file_that_cannot_be_used_is_named(self):
        self.browser.open(PAGE)
        self.give(ROOT / "data/recordings/dead_time.csv.gz", ROOT / "data/scenarios/standstill.toml")
        said = self.browser.run("return document.getElementById('state').textContent")
        self.assertTrue(said.startswith("iqfoc: standstill.toml:"), said)
        self.assertFalse(self.browser.run("return window.iqfoc.json"))

    def test_the_curves_are_the_programs(self):
        self.browser.open(PAGE)
        self.idle()
        last = self.slide("speed", 8000)
        # The 2019 paper's Table 1 at 8000 rpm and 5 kHz lies between two of the points; the program is asked for one itself.
        point = last["points"][7]
        motor = (ROOT / "data/motors/jarzebowicz2019.toml").read_text()
        path = self.folder / "at.toml"
        # (The slider's millihenry are multiplied, which rounds once more than the file's text.)
        path.write_text(motor.replace("f_pwm_Hz = 5000", f"f_pwm_Hz = {last['f_pwm_Hz'][7]!r}").replace("5.2e-3", repr(5.2 * 1e-3)))
        done = subprocess.run([PROGRAM, "sweep", "--motor", path, "--rpm", "8000", "--json", "-"], capture_output=True, text=True,
                              check=True)
        self.assertEqual(point["mean"], json.loads(done.stdout)["points"][0]["mean"])
        self.assertEqual(point["prediction"], json.loads(done.stdout)["points"][0]["prediction"])

    def test_every_slider_redraws(self):
        self.browser.open(PAGE)
        self.idle()
        before = self.browser.run("return window.iqfoc.last")
        for name, value in (("speed", 3000), ("R", 2), ("L", 12), ("psi", 0.2), ("ratio", 1.5), ("belief", 1.6), ("off-R", 0.8),
                            ("off-L", 0.9), ("off-psi", 1.04), ("off-u", 0.98), ("loop", -1.2)):
            after = self.slide(name, value)
            self.assertNotEqual(after, before, name)
            before = after
        self.assertEqual(self.browser.run("return document.querySelectorAll('.chart canvas').length"), 5)
        # Deadbeat control that takes L for 1.6 times what it is overshoots.
        deadbeat = next(m for m in before["step"]["methods"] if m["method"] == "deadbeat, exact")
        self.assertGreater(max(deadbeat["trace"]), 0.75)
        self.picture("sliders.png")

    def test_the_observers_error(self):
        """With true values there is none; a wrong L_q turns the angle by about dL i_q/psi_f, whatever the ratio; a fast loop has more noise."""
        self.browser.open(PAGE)
        self.idle()
        for name in ("off-R", "off-psi", "off-u"):
            self.slide(name, 1)
        points = self.slide("off-L", 1)["observer"]["points"]
        self.assertEqual(20, len(points))
        for point in points:
            self.assertLess(max(abs(x) for x in point["angle_deg"].values()), 0.05)
            self.assertLess(point["disk_observed"], point["disk_measured"])
        wrong = self.slide("off-L", 1.1)["observer"]["points"]
        of_flux = math.degrees(0.1 * 5.2e-3 * 10.5 * math.sqrt(2) / 0.134)
        for point in wrong:
            self.assertEqual(point["angle_deg"]["all"], point["angle_deg"]["L"])
            half = math.pi / point["sffr"]
            at_valley = of_flux / (math.sin(half) / half) ** 2  # the current at the valleys is the mean over this square
            self.assertTrue(0.9 * at_valley < point["angle_deg"]["L"] < 1.2 * at_valley, (point, at_valley))
        for slow, fast in zip(self.slide("loop", -1.4)["observer"]["points"], self.slide("loop", -0.4)["observer"]["points"]):
            self.assertLess(slow["noise_deg"], fast["noise_deg"])
        self.picture("observer.png")

    def settings(self, **values):
        """All of these sliders at once; (the page's complaint, number of charts)."""
        self.browser.run("for (const [n, v] of Object.entries(arguments[0])) { const s = document.getElementById(n); s.value = v; "
                         "s.dispatchEvent(new Event('input')); }", values)
        time.sleep(0.05)
        self.idle()
        return self.browser.run("return [document.getElementById('no-curves').textContent, document.querySelectorAll('.chart canvas').length]")

    def test_the_whole_range_of_the_sliders(self):
        """Slow drives and small inductances have curves. A cycle longer than L/R has none: words, and no picture of other values."""
        self.browser.open(PAGE)
        self.idle()
        charts = self.browser.run("return document.querySelectorAll('.chart canvas').length")
        for values in (dict(speed=2000), dict(speed=8000, L=1), dict(speed=500, L=20, R=0.05, belief=0.5)):
            self.assertEqual(self.settings(**values), ["", charts], values)
        words, left = self.settings(speed=500, R=3, L=1, belief=1)
        self.assertIn("longer than the winding's time constant", words)
        self.assertEqual(left, 0)
        self.assertEqual(self.settings(speed=8000, R=0.75, L=5.2), ["", charts])

    def test_the_golden_hash(self):
        self.browser.open(PAGE)
        self.browser.run("document.getElementById('check').click()")
        self.idle()
        wanted = subprocess.run([PROGRAM, "golden"], capture_output=True, text=True, check=False).stdout.strip()
        shown = self.browser.run("return document.getElementById('golden').textContent")
        self.assertEqual(shown, wanted)
        (PAGE.parent / "golden.txt").write_text(shown + "\n")  # for tools/golden.py

    def test_a_narrow_window(self):
        self.browser.size(400, 800)
        self.addCleanup(self.browser.size, 1200, 900)
        self.browser.open(PAGE)
        self.idle()
        time.sleep(0.3)
        wide = self.browser.run("return document.documentElement.scrollWidth")
        self.assertLessEqual(wide, 400)
        self.picture("narrow.png")


if __name__ == "__main__":
    unittest.main(argv=["web_page"], verbosity=2)
