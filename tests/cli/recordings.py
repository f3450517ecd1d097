"""iqfoc info, plot and motor, and iqfoc diagnose over several recordings. recordings.py IQFOC"""
import pathlib
import re
import sys
import tempfile
import tomllib

import program

MOTOR = program.ROOT / "data/motors/jarzebowicz2019.toml"
DEAD_TIME = program.ROOT / "data/recordings/dead_time.csv.gz"
DEAD_TIME_MOTOR = program.ROOT / "data/recordings/dead_time.toml"
SCENARIO = """name = "two runs"
[control]
feedback = "midpoint"
[[run]]
cycles = 400
speed_rpm = 1500
i_q_A = 6
[[run]]
cycles = 200
speed_rpm = -3000
i_q_A = 3
"""

failures = []


def check(good, what):
    print(("ok    " if good else "FAIL  ") + what)
    if not good:
        failures.append(what)


def refuses(arguments, words, folder, what, stdin=None):
    done = program.run(arguments, folder, stdin)
    lines = done.stderr.decode().strip().split("\n")
    check(done.returncode == 2 and len(lines) == 1 and words in lines[0] and done.stdout == b"", f"{what}: {lines}")


def info(folder):
    done = program.run(["info", "r.csv", "--motor", MOTOR], folder)
    text = done.stdout.decode()
    check(done.returncode == 0 and done.stderr == b"", "info")
    check(text.startswith("r.csv: 600 rows, control cycle 200 us (5000 Hz)\n"), text.split("\n")[0])
    check("omega_e_rad_s" in text and "temp_C" not in text, "the recorded columns alone")
    runs = {line.split()[0]: [float(x) for x in line.split()[1:]] for line in text.splitlines() if re.match(r"^ +\d+ +\d", line)}
    # pole pairs of the file, 200 us: SFFR = 60/(rpm pole_pairs T).
    pairs = tomllib.loads(MOTOR.read_text())["motor"]["pole_pairs"]
    for run, rows, rpm, amperes in (("1", 400, 1500, 6), ("2", 200, -3000, 3)):
        got = runs[run]
        check(got[0] == rows and abs(got[2] - rpm) <= 1 and abs(got[3] - 60 / (abs(rpm) * pairs * 200e-6)) <= 0.06
              and abs(got[4] - amperes) < 0.5, f"run {run}: {got}")
    bars = [line for line in text.splitlines() if "\u2581" in line and "\u2588" in line]
    check(len(bars) == 2 and all(len(re.findall("[\u2581-\u2588]", line)) == 64 for line in bars), "two lines of bars")
    check("electric, Hz" in program.run(["info", "r.csv"], folder).stdout.decode(), "info without a motor file")
    refuses(["info"], "no recording is given", folder, "info of nothing")
    refuses(["info", "r.csv", "r.csv"], "r.csv", folder, "info of two")
    refuses(["info", "none.csv"], "none.csv", folder, "info of a file that is not there")


def plot(folder):
    done = program.run(["plot", "r.csv", "--motor", MOTOR, "-o", "page.html"], folder)
    check(done.returncode == 0 and done.stdout == b"page: page.html\n", "plot")
    page = (folder / "page.html").read_text()
    check(all(words in page for words in ("phase currents, A", "i_d and i_q, A", "phase voltages, V", "speed, rpm", "Recording r.csv"))
          and page.rstrip().endswith("</html>"), "the page is whole")
    (folder / "pages").mkdir()
    for path in (folder / "pages/r.html", pathlib.Path("pages/r.html")):
        check(program.run(["plot", "r.csv", "-o", path], folder).returncode == 0
              and "electrical speed, Hz" in (folder / "pages/r.html").read_text(), f"plot without a motor file, to {path}")
        (folder / "pages/r.html").unlink()
    refuses(["plot", "r.csv"], "--output F.html is missing", folder, "no page")
    refuses(["plot", "r.csv", "-o", "none/r.html"], "none", folder, "a folder that is not there")
    refuses(["plot", "r.csv", "-o", "pages"], "pages", folder, "a folder for a file")
    refuses(["plot", "-o", "x"], "no recording is given", folder, "plot of nothing")
    refuses(["plot", "r.csv", "-o", "r.csv"], "r.csv", folder, "its own recording")


FLAGS = {"--pole-pairs": "4", "--resistance": "0.2", "--inductance": "3e-4", "--kv": "300", "--current": "8", "--u-dc": "24", "--f-pwm": "20e3"}


def words(flags):
    return [x for pair in flags.items() for x in pair]


def motor(folder):
    done = program.run(["motor", "-o", "m.toml", *words(FLAGS), "--line-to-line"], folder)
    check(done.returncode == 0, f"motor: {done.stderr}")
    made = tomllib.loads((folder / "m.toml").read_text())
    # 300 rpm/V line to line, peak: psi_f = 1/(sqrt(3) 300 2 pi/60 4).
    for key, value in (("pole_pairs", 4), ("R_ohm", 0.1), ("L_d_H", 1.5e-4), ("L_q_H", 1.5e-4), ("psi_f_Wb", 0.004594407), ("I_rated_A_rms", 8),
                       ("n_max_rpm", 7200)):
        check(abs(made["motor"][key] / value - 1) < 1e-6, f"{key} = {made['motor'][key]}")
    check(made["inverter"] == {"f_pwm_Hz": 20000, "u_dc_V": 24}, str(made["inverter"]))
    check(program.run(["tune", "--motor", "m.toml", "--drives", "1"], folder).returncode == 0, "another command takes the file")
    done = program.run(["motor", "-o", "q.toml", "--ask"], folder, b"4\n0.1\n1.5e-4\n300\n8\n24\n20000\n")
    asked = tomllib.loads((folder / "q.toml").read_text())
    check(done.returncode == 0 and done.stderr.decode().count(": ") == 7 and asked == made, f"by questions: {done.stderr}")
    two = {**FLAGS, "--inductance": "1e-4,2e-4", "--flux": "0.005", "--speed": "1e5", "--f-pwm": "1e4"}
    del two["--kv"]
    done = program.run(["motor", "-o", "two.toml", *words(two)], folder)
    made = tomllib.loads((folder / "two.toml").read_text())["motor"]
    check((made["L_d_H"], made["L_q_H"], made["psi_f_Wb"], made["n_max_rpm"]) == (1e-4, 2e-4, 0.005, 1e5), "L_d, L_q, flux and speed")
    check(b"note: the library needs SFFR 3" in done.stdout, "too low a frequency is noted")
    for name in FLAGS:
        refuses(["motor", "-o", "n.toml", *words({k: v for k, v in FLAGS.items() if k != name})], f"{name} ", folder, f"without {name}")
    refuses(["motor", *words(FLAGS)], "--output M.toml is missing", folder, "no file")
    refuses(["motor", "-o", "n.toml", *words(FLAGS), "--flux", "0.1"], "same quantity", folder, "flux and Kv")
    refuses(["motor", "-o", "n.toml", *words({**FLAGS, "--pole-pairs": "2.5"})], "no whole number", folder, "half a pole pair")
    refuses(["motor", "-o", "n.toml", "--ask"], "is no number above 0", folder, "an answer that is no number", b"two\n")
    refuses(["motor", "-o", "n.toml", "--ask"], "no answer", folder, "no answer", b"4\n")
    refuses(["motor", "-o", "n.toml", *words({**FLAGS, "--resistance": "-1"})], "--resistance", folder, "a negative resistance")
    check(not (folder / "n.toml").exists(), "nothing is written then")


def slotless(folder):
    """8 uH and 9 mWb: the message has the current base that fits, and with it the firmware takes the motor."""
    flags = {"--pole-pairs": "1", "--resistance": "0.1", "--inductance": "8e-6", "--flux": "9e-3", "--current": "5", "--u-dc": "48",
             "--f-pwm": "20e3", "--speed": "30000"}
    for _ in range(3):
        assert program.run(["motor", "-o", "slotless.toml", *words(flags)], folder).returncode == 0
        done = program.run(["tune", "--motor", "slotless.toml", "--drives", "1"], folder)
        advice = re.search(rb"slotless.toml:\d+:\d+: .*; I_rated_A_rms = (\S+), a larger current base, would fit", done.stderr)
        if advice is None:
            break
        flags["--current"] = advice[1].decode()
    check(float(flags["--current"]) > 30 and b"per-unit constant" not in done.stderr, f"a larger current base: {flags['--current']}, {done.stderr}")


def several(folder):
    done = program.run(["diagnose", DEAD_TIME, "r.csv", DEAD_TIME, "--motor", DEAD_TIME_MOTOR], folder)
    lines = done.stdout.decode().splitlines()
    named = [line for line in lines if line.startswith(f"{DEAD_TIME}: explained, one-cycle error ") and line.endswith(": dead_time")]
    check(len(named) == 2 and named[0] == named[1], f"one line each: {lines}")
    done = program.run(["diagnose", DEAD_TIME, "none.csv", DEAD_TIME, "--motor", DEAD_TIME_MOTOR, "--exit-verdict"], folder)
    check(done.returncode == 2 and len(done.stdout.splitlines()) == 2 and done.stderr.count(b"\n") == 1 and b"none.csv" in done.stderr,
          "one that is not there does not stop the others")
    done = program.run(["diagnose", DEAD_TIME, DEAD_TIME, "--motor", DEAD_TIME_MOTOR, "--exit-verdict"], folder)
    check(done.returncode == 10, "the status of the worst verdict")
    for option in (["-o", "out"], ["--json", "-"]):
        refuses(["diagnose", DEAD_TIME, "r.csv", "--motor", DEAD_TIME_MOTOR, *option], "take one recording", folder, f"several with {option[0]}")


with tempfile.TemporaryDirectory() as name:
    place = pathlib.Path(name)
    (place / "s.toml").write_text(SCENARIO)
    assert program.run(["simulate", "--motor", MOTOR, "--scenario", "s.toml", "-o", "r.csv"], place).returncode == 0
    for part in (info, plot, motor, slotless, several):
        part(place)
sys.exit(1 if failures else 0)
