"""The page for the browser with a board: the emulated Cortex-M4 records while the page listens, by a stand-in for Web Serial that gets the
octets of the emulated UART, and gives it some, over a small bridge on loopback.

    live_page.py IQFOC PAGE.html [FOLDER for pictures]       (build/cortex-m4/iqfoc_pil.elf next to IQFOC's folder)"""

import http.server
import json
import os
import pathlib
import pty
import select
import subprocess
import sys
import tempfile
import threading
import time
import tty
import unittest

import browser

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM, PAGE = (pathlib.Path(path).resolve() for path in sys.argv[1:3])
PICTURES = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else None
MOTOR = ROOT / "data/motors/jarzebowicz2019.toml"
SCENARIO = ROOT / "data/scenarios/identification.toml"
HIDDEN = "dead_time:t_dead=1e-6,v_switch=1.5,v_diode=1.2"
STEP = 3000  # octets at once, as a driver gives them
# A run that needs more voltage than there is from between 2 and 3 s on.
RAMP = """name = "ramp"
[[run]]
duration_s = 12.0
speed_rpm = { at_s = [0.0, 2.0, 3.0, 12.0], ramp = [7000.0, 7000.0, 10000.0, 10000.0] }
i_q_A = 8
"""

# What the page uses of navigator.serial (https://wicg.github.io/serial/); octets come from the bridge.
STAND_IN = """
const url = arguments[0];
window.serialSaid = [];
const port = {
    async open(options) {
        window.serialSaid.push(options.baudRate);
        let at = 0, open = true;
        this.readable = new ReadableStream({
            async pull(to) {
                while (open) {
                    const answer = await fetch(url + "?from=" + at);
                    const octets = new Uint8Array(await answer.arrayBuffer());
                    at += octets.length;
                    if (octets.length > 0) { to.enqueue(octets); return; }
                    if (answer.status === 410) { to.close(); return; }
                }
            },
            cancel() { open = false; },
        });
        this.writable = new WritableStream({write: (octets) => fetch(url, {method: "POST", body: octets})});
    },
    async close() { if (this.readable.locked) throw new Error("the stream is locked"); window.serialSaid.push("closed"); },
};
Object.defineProperty(navigator, "serial", {configurable: true, value: {requestPort: async () => port}});
"""


class Board:
    """The emulated Cortex-M4 with its UART on a terminal: what it sends goes into a file."""

    def __init__(self, folder, name, scenario, *more):
        self.path, self.over = folder / name, False
        self.master, self.slave = pty.openpty()
        tty.setraw(self.slave)
        self.program = subprocess.Popen([PROGRAM, "simulate", "--motor", MOTOR, "--scenario", scenario, "--target", "cortex-m4", "--uart",
                                         os.ttyname(self.slave), "-o", folder / "host.csv", *more])
        threading.Thread(target=self.listen, daemon=True).start()

    def listen(self):
        with open(self.path, "wb", buffering=0) as file:
            while select.select([self.master], [], [], 0.2)[0] or self.program.poll() is None:
                if select.select([self.master], [], [], 0)[0]:
                    file.write(os.read(self.master, 65536))
        self.over = True

    def write(self, octets):
        os.write(self.master, octets)

    def end(self):
        self.program.terminate()
        self.program.wait()
        while not self.over:
            time.sleep(0.01)
        os.close(self.master)
        os.close(self.slave)


class Bridge(http.server.ThreadingHTTPServer):
    """A file that grows, or a part of one; 410 where there will be no more. What is posted goes to `write`."""

    def __init__(self, path, ended, write=None):
        super().__init__(("127.0.0.1", 0), Answer)
        self.path, self.ended, self.write = path, ended, write
        threading.Thread(target=self.serve_forever, daemon=True).start()

    def url(self):
        return f"http://127.0.0.1:{self.server_address[1]}/"


class Answer(http.server.BaseHTTPRequestHandler):
    def do_GET(self):
        at = int(self.path.rsplit("=", 1)[1])
        over = self.server.ended()
        octets = b""
        if self.server.path.exists():
            with open(self.server.path, "rb") as file:
                file.seek(at)
                octets = file.read(STEP)
        if not octets and not over:
            time.sleep(0.02)
        self.send_response(200 if octets or not over else 410)
        self.send_header("Access-Control-Allow-Origin", "*")
        self.send_header("Content-Length", str(len(octets)))
        self.end_headers()
        self.wfile.write(octets)

    def do_POST(self):
        self.server.write(self.rfile.read(int(self.headers["Content-Length"])))
        self.send_response(200)
        self.send_header("Access-Control-Allow-Origin", "*")
        self.send_header("Content-Length", "0")
        self.end_headers()

    def log_message(self, *_):
        pass


class Live(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.browser = browser.Browser(1200, 900)
        cls.board = Board(cls.folder, "board.octets", SCENARIO, "--effect", HIDDEN)
        cls.uart = cls.board.path

    @classmethod
    def tearDownClass(cls):
        cls.board.end()
        cls.browser.__exit__()
        cls.temporary.cleanup()

    def script(self, text, *values):
        return self.browser.run(text, *values)

    def text(self, name):
        return self.script("return document.getElementById(arguments[0]).textContent", name)

    def wait(self, condition, what, seconds=400):
        end = time.monotonic() + seconds
        while not self.script("return " + condition):
            self.assertLess(time.monotonic(), end, f"{what}; the page says: {self.text('line-state')}")
            time.sleep(0.1)

    def set(self, name, value):
        self.script("const i = document.getElementById(arguments[0]); i.value = arguments[1]; i.dispatchEvent(new Event('input'))",
                    name, value)

    def picture(self, name, of, width=1200):
        if PICTURES is not None:
            PICTURES.mkdir(parents=True, exist_ok=True)
            self.browser.size(width, 900)
            time.sleep(0.5)
            self.script("document.getElementById(arguments[0]).scrollIntoView()", of)
            time.sleep(1.5)
            self.browser.picture(PICTURES / name)
            self.browser.size(1200, 900)

    def bridge(self, path, ended, write=None):
        made = Bridge(path, ended, write)
        self.addCleanup(made.server_close)
        self.addCleanup(made.shutdown)
        return made

    def connect(self, bridge, *ticks, motor=True):
        self.browser.open(PAGE)
        for name in ticks:
            self.script("document.getElementById(arguments[0]).checked = true", name)
        self.script(STAND_IN, bridge.url())
        if motor:
            found = self.browser.call("/element", {"using": "css selector", "value": "#choose"})
            self.browser.call(f"/element/{next(iter(found.values()))}/value", {"text": str(MOTOR)})
            self.wait("document.getElementById('have-motor').textContent !== 'none yet'", "no motor file")
        self.script("document.getElementById('connect').click()")

    def test_1_the_board_while_it_runs(self):
        """Scope and trigger at the recorder's rate; then recording and diagnosis, both as the program's."""
        self.addCleanup(self.browser.console)
        bridge = self.bridge(self.uart, lambda: self.board.over)
        self.connect(bridge, "several")
        self.wait("window.iqfoc.line.drawn >= 400", "no rows on the scope")
        self.assertFalse(self.board.over, "the board was to run still")
        self.picture("scope.png", "line-state")
        self.set("trigger-column", "i_beta_A")
        self.set("level", 1)
        self.set("trigger", 1)
        self.script("document.getElementById('single').checked = true")
        self.wait("window.iqfoc.line.crossing", "no trigger")
        low, high = self.script("return window.iqfoc.line.crossing")
        self.assertTrue(self.script("return window.iqfoc.line.rises"), "time runs back on the scope")
        self.assertTrue(low < 1 <= high, (low, high))
        self.picture("trigger.png", "line-state")
        self.picture("scope_400.png", "line-state", 400)
        self.assertEqual(self.script("return document.documentElement.scrollWidth <= document.documentElement.clientWidth"), True)
        self.wait("window.iqfoc.line.finished && window.iqfoc.busy === 0", "no end")

        told = subprocess.run([PROGRAM, "record", "--port", self.stream(), "-o", self.folder / "recording.csv"],
                              capture_output=True, text=True, check=True)
        recording = (self.folder / "recording.csv").read_text()
        self.assertEqual(self.script("return window.iqfoc.recording"), recording)
        rows = sum(1 for line in recording.splitlines() if line[0] != "#") - 1
        self.assertEqual(self.script("return window.iqfoc.line.rows"), rows, told.stderr)
        status = dict(self.script("return [...document.querySelectorAll('#status tr')].map((r) => [...r.cells].map((c) => c.textContent))"))
        self.assertEqual([status[name] for name in ("rows", "rows a second", "trigger", "damaged frames", "missing rows")],
                         [str(rows), "5000", "taken", "0", "0"])
        self.assertIn("0 damaged, 0 lost", self.text("line-state"))
        subprocess.run([PROGRAM, "diagnose", "recording.csv", "--motor", self.motor(), "--json", "board.json"], cwd=self.folder,
                       capture_output=True, check=True)
        mine = self.script("return window.iqfoc.json")
        self.assertEqual(mine, (self.folder / "board.json").read_text())
        self.assertEqual(json.loads(mine)["causes"][0]["id"], "dead_time")
        self.assertEqual(self.script("return window.serialSaid"), [1000000, "closed"])

    def motor(self):
        (self.folder / MOTOR.name).write_bytes(MOTOR.read_bytes())
        return MOTOR.name

    def stream(self, uart=None):
        """The octets that the page makes its recording from."""
        first, taken = self.script("return [window.iqfoc.line.from, window.iqfoc.line.taken]")
        path = self.folder / "taken.octets"
        path.write_bytes((uart or self.uart).read_bytes()[first:taken])
        return path

    def test_2_a_line_that_breaks_off(self):
        """Stop, and a line that carries something else: what came is used, or refused in words; the page can connect again."""
        while not self.board.over:
            time.sleep(0.1)
        part = self.folder / "part.octets"
        part.write_bytes(self.uart.read_bytes()[:60000])
        bridge = self.bridge(part, lambda: False)
        self.connect(bridge, motor=False)
        self.wait("window.iqfoc.line.taken === 60000", "not all octets")
        self.script("document.getElementById('stop').click()")
        self.wait("window.iqfoc.line.finished", "no end")
        self.assertIn("drop the motor file", self.text("line-state"))
        self.assertEqual(self.text("have-recording"), "recording.csv")
        self.assertFalse(self.script("return document.getElementById('connect').disabled"))

        part.write_bytes(b"just text\n" * 100)
        self.script(STAND_IN, self.bridge(part, lambda: True).url())
        self.script("document.getElementById('connect').click()")
        self.wait("window.iqfoc.line.finished", "no end")
        self.assertIn("no row received", self.text("line-state"))

    def test_5_a_trigger_in_the_board(self):
        """Set from the page while the board runs: it answers, records one memory full, and the page makes the recording of that alone.
        Status bits come with the rows."""
        scenario = self.folder / "ramp.toml"
        scenario.write_text(RAMP)
        self.addCleanup(self.browser.console)
        board = Board(self.folder, "ramp.octets", scenario)
        self.addCleanup(board.end)
        self.connect(self.bridge(board.path, lambda: board.over, board.write))
        self.wait("window.iqfoc.line.drawn >= 50", "no rows on the scope")
        for name, value in (("board-trigger", 2), ("board-column", "i_beta_A"), ("board-level", 1.5), ("board-before", 1),
                            ("board-decimation", 2)):
            self.set(name, value)
        self.script("document.getElementById('board-set').click()")
        self.wait("window.iqfoc.line.confirmed", "no answer: " + self.text("board-state"), 60)
        self.assertEqual(self.text("board-state"), "The board has it: recording 2.")
        answer = self.script("return window.iqfoc.line.answer")
        self.assertEqual([answer[name] for name in ("error", "trigger", "channel", "decimation")], [0, 2, 1, 2])
        self.assertAlmostEqual(answer["level"], 1.5, 5)
        self.assertAlmostEqual(answer["pre_share"], 0.01, 6)
        self.wait("window.iqfoc.line.finished", "no end")
        self.picture("board_trigger.png", "line-state")
        subprocess.run([PROGRAM, "record", "--port", self.stream(board.path), "-o", self.folder / "triggered.csv"], capture_output=True, check=True)
        recording = (self.folder / "triggered.csv").read_text()
        self.assertEqual(self.script("return window.iqfoc.recording"), recording)
        lines = [line.split(",") for line in recording.splitlines() if line[0] != "#"]
        rows = [dict(zip(lines[0], map(float, line))) for line in lines[1:]]
        self.assertEqual(len(rows), 10000)
        self.assertAlmostEqual(rows[1]["t_s"] - rows[0]["t_s"], 2 / 5000, 9)
        beta = [(row["i_a_A"] + 2 * row["i_b_A"]) / 3 ** 0.5 for row in rows]
        fires = next(k for k in range(1, len(beta)) if beta[k - 1] < 1.5 <= beta[k])
        self.assertLessEqual(fires, 100)
        self.assertEqual(self.script("return window.iqfoc.line.status.last"), ["VOLTAGE_LIMIT"])
        self.assertIn("VOLTAGE_LIMIT", self.text("status-bits"))

    def test_3_without_web_serial(self):
        self.browser.open(PAGE)
        self.script("Object.defineProperty(navigator, 'serial', {configurable: true, value: undefined});"
                    "document.getElementById('connect').click()")
        self.wait("document.getElementById('line-state').className === 'bad'", "no words")
        self.assertIn("iqfoc record", self.text("line-state"))

    def test_4_the_browser_has_it_from_disk(self):
        self.browser.open(PAGE)
        self.assertEqual(self.script("return [isSecureContext, 'serial' in navigator]"), [True, True])


if __name__ == "__main__":
    unittest.main(argv=["live_page"], verbosity=2)
