#!/usr/bin/env python3
"""The report page in a browser: headless Chromium opens what `iqfoc diagnose -o DIR` wrote, from disk.

No script fails and nothing is asked of a network; all curves are drawn; zoom, linked cursors and the switches of the two models work; at
400 px nothing is wider than the page; dark and print have their colours; names of the user's stay text; and a million rows are zoomed
into without losing a peak or a gap.

    report_page.py PROGRAM
"""

import base64
import math
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import time
import unittest

from browser import Browser

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(sys.argv[1]).resolve()
sys.path.insert(0, str(ROOT / "tests/cli"))
import program  # noqa: E402 (the motor file of the command line's tests)

EVIL = "<img src=x onerror=\"window.evil=1\">.csv"
SCENARIO = """name = "some speeds"
[control]
feedback = "midpoint"
[sensors]
current_noise_A = 0.02
""" + "".join(f"""[[run]]
cycles = 900
speed_rpm = {rpm}
i_q_A = {{ value = 3, square = {{ amplitude = 2, period_s = 0.02 }} }}
i_d_A = {{ value = -1, square = {{ amplitude = 1, period_s = 0.013 }} }}
""" for rpm in (300, -900, 2500))
MILLION = 1000000
SPIKE = 654321
GAP = 345678

# How many points of each canvas have a colour other than the paper's, within a curve's hue.
PAINTED = """
const wanted = arguments[0];
return [...document.querySelectorAll("canvas")].map((canvas) => {
    const points = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    let count = 0;
    for (let n = 0; n < points.length; n += 4) {
        count += points[n + 3] > 200 && wanted.some((c) => Math.abs(points[n] - c[0]) + Math.abs(points[n + 1] - c[1])
            + Math.abs(points[n + 2] - c[2]) < 60);
    }
    return count;
});"""
LIGHT = {"blue": (0, 114, 178), "orange": (213, 94, 0), "green": (0, 158, 115), "purple": (170, 68, 153), "faint": (140, 140, 140)}
DARK = {"blue": (90, 180, 236), "orange": (255, 143, 74), "green": (60, 207, 158), "purple": (224, 138, 210), "faint": (133, 137, 142)}
SCALES = "return iqfocReport.panels.filter((p) => p.chart.group).map((p) => [p.plot.scales.x.min, p.plot.scales.x.max]);"
LINKED = "const linked = iqfocReport.panels.filter((p) => p.chart.group);"
FULL = "return iqfocReport.panels.find((p) => p.chart.group).full;"


def write_report(folder):
    (folder / "motor.toml").write_text(program.MOTOR.replace("Compressor 2.2 kW", "</script><script>window.evil = 2</script>"))
    (folder / "scenario.toml").write_text(SCENARIO)
    for arguments in (["simulate", "--motor", "motor.toml", "--scenario", "scenario.toml", "--effect", "dead_time", "-o", EVIL],
                      ["diagnose", EVIL, "--motor", "motor.toml", "-o", "out"]):
        done = program.run(arguments, folder)
        assert done.returncode == 0, done.stderr
    return folder / "out/report.html"


def packed(kind, numbers):
    return base64.b64encode(struct.pack(f"<{len(numbers)}{kind}", *numbers)).decode()


def with_a_million_rows(page, folder):
    """The page with the numbers of its plot over time replaced: a slow wave with one sample far off and one row without values."""
    wave = [int(20000 * math.sin(n * 2e-5)) for n in range(MILLION)]
    wave[SPIKE] = 32767
    wave[GAP] = -32768
    column = f'{{"i2":"{packed("h", wave)}","middle":0,"step":0.001}}'
    columns = ",".join([f'{{"pieces":[[0,0.0001,{MILLION}]]}}', *[column] * 8])
    before, figure = page.read_text().split('<figure id="waveform"')
    figure = re.sub(r'"columns":\[.*?\]\}\n</script>', lambda _: f'"columns":[{columns}]}}\n</script>', figure, count=1, flags=re.DOTALL)
    text = f'{before}<figure id="waveform"{figure}'
    text = re.sub(r'"view":\[[^]]*\],', "", text)
    (folder / "million.html").write_text(text)
    return folder / "million.html"


class ReportPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.page = write_report(cls.folder)
        cls.browser = Browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.__exit__()
        cls.temporary.cleanup()

    def setUp(self):
        self.scheme("light")
        self.browser.size(1200, 900)
        self.browser.open(self.page)

    def tearDown(self):
        self.assertEqual([], self.browser.console())

    def scheme(self, name):
        self.browser.devtools("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": name}]})

    def wait_for(self, script, says):
        end = time.monotonic() + 10
        while not self.browser.run(script):
            self.assertLess(time.monotonic(), end, says)
            time.sleep(0.05)

    def first_plot(self):
        """Where the plot of the first of the linked charts is in the window, scrolled into it."""
        return self.browser.run("""const over = iqfocReport.panels.find((p) => p.chart.group).plot.over;
            over.scrollIntoView({block: "center"});
            const box = over.getBoundingClientRect();
            return {x: box.x, y: box.y, width: box.width, height: box.height};""")

    def test_all_is_drawn_and_nothing_asked_for(self):
        painted = self.browser.run(PAINTED, list(LIGHT.values()))
        self.assertGreaterEqual(len(painted), 10)
        for n, count in enumerate(painted):
            self.assertGreater(count, 20, f"chart {n} is blank")
        self.assertEqual(0, self.browser.run("return document.querySelectorAll('.failed').length"))
        self.assertEqual([], self.browser.run("return performance.getEntriesByType('resource').map((r) => r.name)"))
        self.assertIsNone(self.browser.run("return window.evil"))
        self.assertEqual(0, self.browser.run("return document.querySelectorAll('img').length"))
        self.assertIn(EVIL, self.browser.run("return document.querySelector('h1').textContent"))

    def test_zoom_is_linked(self):
        at = self.first_plot()
        before = self.browser.run(SCALES)
        self.browser.drag(at["x"] + 0.25 * at["width"], at["y"] + 0.5 * at["height"], at["x"] + 0.5 * at["width"])
        self.wait_for(f"{SCALES.replace('return', 'const s =')} return s[0][1] - s[0][0] < {0.5 * (before[0][1] - before[0][0])};", "no zoom")
        after = self.browser.run(SCALES)
        size = before[0][1] - before[0][0]
        self.assertAlmostEqual(before[0][0] + 0.25 * size, after[0][0], delta=0.01 * size)
        self.assertAlmostEqual(before[0][0] + 0.5 * size, after[0][1], delta=0.01 * size)
        self.assertEqual([after[0]] * 4, after)
        self.assertGreater(min(self.browser.run(PAINTED, list(LIGHT.values()))), 20)
        self.browser.run("[...document.querySelectorAll('figure.wide .zoom button')].find((b) => b.textContent === 'all').click()")
        self.assertEqual([self.browser.run(FULL)] * 4, self.browser.run(SCALES))
        self.browser.run("document.querySelector('figure.wide .zoom button').click()")
        self.assertLess(self.browser.run(SCALES)[3][1] - self.browser.run(SCALES)[3][0], 0.5 * self.browser.run(FULL)[1])

    def test_cursors_are_linked(self):
        at = self.first_plot()
        self.browser.point(at["x"] + 0.4 * at["width"], at["y"] + 0.5 * at["height"])
        self.wait_for(f"{LINKED} return linked[2].plot.cursor.left > 0", "no cursor in the third chart")
        lefts = self.browser.run(f"{LINKED} return linked.map((p) => p.plot.cursor.left)")
        self.assertEqual(4, len(lefts))
        self.assertLess(max(lefts) - min(lefts), 2)
        values = self.browser.run(f"{LINKED} return linked.map((p) => p.box.querySelector('.u-legend').textContent)")
        for text in values:
            self.assertRegex(text, r"\d\.\d")

    def test_the_switches_of_the_models(self):
        for role, paint, other in (("nominal", "orange", "blue"), ("extended", "blue", "orange")):
            before = self.browser.run(PAINTED, [LIGHT[paint]])
            kept = self.browser.run(PAINTED, [LIGHT[other]])
            self.browser.run(f"document.querySelector('input[name={role}]').click()")
            time.sleep(0.2)
            after = self.browser.run(PAINTED, [LIGHT[paint]])
            self.assertGreater(sum(before), 500)
            self.assertLess(sum(after), 0.03 * sum(before), role)
            self.assertGreater(sum(self.browser.run(PAINTED, [LIGHT[other]])), 0.9 * sum(kept), role)
            self.browser.run(f"document.querySelector('input[name={role}]').click()")
            time.sleep(0.2)
            self.assertGreater(sum(self.browser.run(PAINTED, [LIGHT[paint]])), 0.9 * sum(before), role)

    def test_narrow(self):
        self.browser.size(400, 800)
        self.browser.open(self.page)
        self.wait_for("return iqfocReport.panels.every((p) => p.plot.width <= 400)", "a chart is wider than the page")
        self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), 400)
        self.assertTrue(self.browser.run("return [...document.querySelectorAll('.table')].some((t) => t.scrollWidth > t.clientWidth)"))
        self.assertGreater(min(self.browser.run(PAINTED, list(LIGHT.values()))), 20)

    def test_a_window_that_becomes_narrow(self):
        self.browser.size(500, 800)
        self.wait_for("return document.documentElement.scrollWidth <= 500 && iqfocReport.panels.every((p) => p.plot.width <= 500)",
                      "the charts keep their width")

    def test_dark_and_back(self):
        self.scheme("dark")
        self.browser.open(self.page)
        self.assertEqual("rgb(22, 24, 27)", self.browser.run("return getComputedStyle(document.body).backgroundColor"))
        self.assertGreater(min(self.browser.run(PAINTED, list(DARK.values()))), 20)
        self.browser.run("""const choice = document.querySelector("select[name=theme]");
            choice.value = "light"; choice.dispatchEvent(new Event("change"));""")
        time.sleep(0.2)
        self.assertEqual("rgb(255, 255, 255)", self.browser.run("return getComputedStyle(document.body).backgroundColor"))
        self.assertGreater(min(self.browser.run(PAINTED, list(LIGHT.values()))), 20)

    def test_print(self):
        self.scheme("dark")
        self.browser.open(self.page)
        pdf = self.browser.print()
        self.assertGreater(len(re.findall(rb"/Type\s*/Page\b", pdf)), 2)
        self.assertGreater(len(pdf), 100000)
        self.browser.run("window.dispatchEvent(new Event('beforeprint'))")
        time.sleep(0.2)
        self.assertEqual("rgb(255, 255, 255)", self.browser.run("return getComputedStyle(document.body).backgroundColor"))
        self.assertGreater(min(self.browser.run(PAINTED, list(LIGHT.values()))), 20)
        self.assertLessEqual(max(self.browser.run("return iqfocReport.panels.map((p) => p.plot.width)")), 640)
        self.browser.run("window.dispatchEvent(new Event('afterprint'))")
        self.assertEqual("rgb(22, 24, 27)", self.browser.run("return getComputedStyle(document.body).backgroundColor"))

    def test_a_million_rows(self):
        self.browser.open(with_a_million_rows(self.page, self.folder))
        told = self.browser.run("""const p = iqfocReport.panels.find((q) => q.chart.group);
            const before = performance.now();
            iqfocReport.zoom(p, p.full);
            return {points: p.plot.data[0].length, most: Math.max(...p.plot.data[1]),
                    gaps: p.plot.data[0].filter((x, n) => p.plot.data.every((t, k) => k === 0 || t[n] === null)), took: performance.now() - before};""")
        self.assertLess(told["points"], 10000)
        self.assertAlmostEqual(32.767, told["most"], places=6)
        self.assertEqual([GAP], [round(x / 1e-4) for x in sorted(set(told["gaps"]))])
        self.assertLess(told["took"], 3000)
        told = self.browser.run(f"""const p = iqfocReport.panels.find((q) => q.chart.group);
            iqfocReport.zoom(p, [{(SPIKE - 20) * 1e-4}, {(SPIKE + 20) * 1e-4}]);
            return {{x: p.plot.data[0], y: p.plot.data[1]}};""")
        self.assertLess(len(told["x"]), 50)
        self.assertAlmostEqual(SPIKE * 1e-4, told["x"][told["y"].index(max(told["y"]))], places=9)


if __name__ == "__main__":
    unittest.main(argv=[__file__, "-v"])
