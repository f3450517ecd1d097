"""Two updates a carrier period: a row per half period, and one clear line from what cannot use it. half_cycles.py IQFOC"""
import csv
import math
import pathlib
import subprocess
import sys
import tempfile

SCENARIO = """name = "halves"
[control]
feedback = "quasi_discrete_mean"
updates = 2
[[run]]
cycles = 400
speed_rpm = 3000
i_d_A = -2
i_q_A = 6
"""
F_PWM_HZ = 5000.0

failures = []


def check(good, what):
    print(("ok    " if good else "FAIL  ") + what)
    if not good:
        failures.append(what)


def run(program, *words):
    return subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False, timeout=1200)


def refuses(done, words, what):
    lines = done.stderr.strip().split("\n")
    check(done.returncode == 2 and len(lines) == 1 and words in lines[0], f"{what}: {done.stderr.strip()}")


def currents(row):
    """i_d and i_q of a row, amplitude-invariant."""
    a, b, c = (float(row[f"i_{x}_A"]) for x in "abc")
    alpha, beta = (2 * a - b - c) / 3, (b - c) / math.sqrt(3)
    cos, sin = math.cos(float(row["theta_e_rad"])), math.sin(float(row["theta_e_rad"]))
    return alpha * cos + beta * sin, beta * cos - alpha * sin


def main():
    program = sys.argv[1]
    motor = pathlib.Path("data/motors/jarzebowicz2019.toml")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scenario, recording = folder / "s.toml", folder / "r.csv"
        scenario.write_text(SCENARIO)
        done = run(program, "simulate", "--motor", motor, "--scenario", scenario, "-o", recording)
        check(done.returncode == 0, f"simulates {done.stderr}")
        with recording.open(newline="") as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        steps = {round((float(b["t_s"]) - float(a["t_s"])) * 2 * F_PWM_HZ, 6) for a, b in zip(rows, rows[1:])}
        check(len(rows) == 400 and steps == {1.0}, f"{len(rows)} rows, half a period apart: {steps}")
        check(not any("mid" in column for column in rows[0]), "no samples in the middle")
        turned = (float(rows[1]["theta_e_rad"]) - float(rows[0]["theta_e_rad"])) % (2 * math.pi)
        want = 3000 / 60 * 3 * 2 * math.pi / (2 * F_PWM_HZ)
        check(abs(turned - want) < 1e-9, f"the rotor turns by {turned:.6f} rad in a row, {want:.6f}")
        d, q = (sum(x) / len(rows) for x in zip(*map(currents, rows)))
        check(math.hypot(d + 2, q - 6) < 0.2, f"the current follows its reference: {d:.3f}, {q:.3f} A")

        refuses(run(program, "diagnose", recording, "--motor", motor, "-o", folder / "d"),
                "rows of half a carrier period (two updates) cannot be diagnosed", "diagnose")
        refuses(run(program, "simulate", "--motor", motor, "--scenario", scenario, "-o", folder / "x.csv", "--target", "cortex-m4"),
                "only `iqfoc simulate` without --target runs two updates", "an emulated target")
        scenario.write_text(SCENARIO + "[log]\nmid_currents = true\n")
        refuses(run(program, "simulate", "--motor", motor, "--scenario", scenario, "-o", folder / "x.csv"),
                "updates = 2 has no mid_currents", "samples in the middle of a half")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
