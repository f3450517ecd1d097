"""iqfoc patterns: its table, JSON and header against the equations and a search written here, and what it refuses. patterns.py IQFOC"""
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import program

MOTOR = program.ROOT / "data/motors/compressor_salient.toml"
ORDERS = [n for n in range(5, 98, 2) if n % 3]

failures = []


def check(good, what):
    print(("ok    " if good else "FAIL  ") + what)
    if not good:
        failures.append(what)


def refuses(arguments, words, folder, what):
    done = program.run(["patterns", *arguments], folder)
    lines = done.stderr.decode().strip().split("\n")
    check(done.returncode == 2 and len(lines) == 1 and words in lines[0] and done.stdout == b"", f"{what}: {lines}")


def result(folder, *arguments):
    done = program.run(["patterns", *arguments, "--json", "-"], folder)
    assert done.returncode == 0, done.stderr
    got = json.loads(done.stdout)
    return {**got, **got["patterns"][0]}


def harmonic(order, start, angles):
    return 4 * start / (math.pi * order) * (1 + 2 * sum((-1) ** (k + 1) * math.cos(order * x) for k, x in enumerate(angles)))


def distortion(start, angles):
    return math.sqrt(sum((harmonic(n, start, angles) / n) ** 2 for n in ORDERS)) / abs(harmonic(1, start, angles))


def least_of_five_pulses(index):
    """Both families, every second angle in steps of 1/20 degree; the index gives the first."""
    best = math.inf
    for start in (1, -1):
        for step in range(1, 1800):
            second = math.radians(step / 20)
            cosine = (1 + 2 * math.cos(second) - start * index) / 2
            if abs(cosine) <= 1 and math.acos(cosine) <= second:
                best = min(best, distortion(start, (math.acos(cosine), second)))
    return best


def compare(folder):
    for pulses in (3, 5, 9):
        got = result(folder, "--pulses", pulses)
        check(len(got["rows"]) == 70 and got["motor"] is None and got["distortion_of"] == "fundamental flux", f"{pulses} pulses: the whole range")
        for row in got["rows"]:
            angles = [math.radians(x) for x in row["angles_deg"]]
            good = (len(angles) == (pulses - 1) / 2 and angles == sorted(angles) and 0 < angles[0] and angles[-1] < math.pi / 2 + 1e-12
                    and abs(harmonic(1, row["start"], angles) * math.pi / 4 - row["index"]) < 1e-7
                    and abs(distortion(row["start"], angles) - row["distortion"]) < 1e-9
                    and (row["space_vectors"] is None or row["distortion"] < row["space_vectors"]) and row["frequency_Hz"] is None)
            if not good:
                check(False, f"{pulses} pulses: {row}")
        check(sum(not row["joined"] for row in got["rows"]) == got["jumps"] + 1, f"{pulses} pulses: {got['jumps']} jumps")
        if pulses == 3:
            check(all(min(abs(x - math.degrees(math.acos((1 - row["start"] * row["index"]) / 2))) for x in row["angles_deg"]) < 1e-5
                      for row in got["rows"]), "three pulses: the angle is the one that the index determines")
        if pulses == 5:
            for row in got["rows"][::6]:
                least = least_of_five_pulses(row["index"])
                # Near a jump the table stays with a pattern that is little worse.
                check(0.999 * least < row["distortion"] < 1.03 * least, f"five pulses at {row['index']:.2f}: {row['distortion']:.5f}, at best {least:.5f}")


def with_motor(folder):
    got = result(folder, "--motor", MOTOR, "--pulses", 7, "--on-time-us", 6, "--dead-time-us", 2)
    flux = math.hypot(0.2, 0.011 * 6 * math.sqrt(2))
    six_step = 565 * 2 / math.pi / flux / (2 * math.pi)
    gaps = []
    for row in got["rows"]:
        edges = [0, *row["angles_deg"], *(180 - x for x in reversed(row["angles_deg"]))]
        gaps.append(min(b - a for a, b in zip(edges, edges[1:])) / (360 * row["index"] * six_step))
    check(abs(got["rows"][0]["frequency_Hz"] - 0.3 * six_step) < 1e-9 and abs(got["load_angle_deg"] - math.degrees(math.acos(0.2 / flux))) < 1e-9,
          "frequency and load angle are those of the rated flux")
    check(min(gaps) > 8e-6 - 1e-12, f"the least time between edges is {min(gaps) * 1e6:.4f} us")
    check(got["distortion_of"] == "rated current" and got["motor"] == "Compressor 2.2 kW", "it says what the distortion is of")


def write(folder):
    done = program.run(["patterns", "--motor", MOTOR, "-o", "out", "--json", "out/x.json"], folder)
    check(done.returncode == 0 and b"page: out/index.html, firmware's table: out/iqfoc_pattern.h" in done.stdout and b"jumps of the angles" in done.stdout,
          done.stdout.decode())
    page = (folder / "out/index.html").read_text()
    check("space vectors" in page and page.rstrip().endswith("</html>"), "the page is whole")
    rows = json.loads((folder / "out/x.json").read_text())["patterns"][0]["rows"]
    header = (folder / "out/iqfoc_pattern.h").read_text()
    table = [[int(x) for x in re.findall(r"-?\d+", line.split("/*")[0])] for line in header.split("\n") if line.startswith("    {")]
    check([line[:2] for line in table] == [[row["start"], row["joined"]] for row in rows]
          and all(abs(x / 2**24 * 360 - angle) <= 180 / 2**24 + 1e-9 for line, row in zip(table, rows) for x, angle in zip(line[2:], row["angles_deg"])),
          "the header has the JSON's angles")
    (folder / "out/firmware.c").write_text('#include "iqfoc_pattern.h"\nint main(void) { return iqfoc_pattern_7.row[iqfoc_pattern_7.rows - 1].joined; }\n')
    for compiler in filter(shutil.which, ("gcc", "clang")):
        made = subprocess.run([compiler, "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", "-I", str(program.ROOT / "include"), "firmware.c", "-o", "firmware"],
                              cwd=folder / "out", capture_output=True, check=False)
        check(made.returncode == 0 and subprocess.run(["./firmware"], cwd=folder / "out", check=False).returncode == 0, f"{compiler} {made.stderr.decode()}")


def several(folder):
    done = program.run(["patterns", "--pulses", "3,5", "-o", "both", "--json", "both/x.json"], folder)
    check(done.returncode == 0 and b"3 pulses a turn" in done.stdout and b"5 pulses a turn" in done.stdout, "two numbers of pulses")
    both = json.loads((folder / "both/x.json").read_text())["patterns"]
    check([one["pulses"] for one in both] == [3, 5] and both[1]["rows"] == result(folder, "--pulses", 5)["rows"], "each as by itself")
    header = (folder / "both/iqfoc_pattern.h").read_text()
    check("iqfoc_pattern_3 = {iqfoc_pattern_3_rows, 70, 1," in header and "iqfoc_pattern_5 = {iqfoc_pattern_5_rows, 70, 2," in header, "a table for each")


def refuse(folder):
    refuses(["--pulses", "8"], "--pulses has 8; expected odd numbers, rising", folder, "an even number")
    refuses(["--pulses", "7,5"], "--pulses has 5; expected odd numbers, rising", folder, "numbers that fall")
    refuses(["--pulses", "17"], "15", folder, "too many pulses")
    refuses(["--on-time-us", "5"], "a least time needs --frequency HZ or --motor M.toml", folder, "a time without a frequency")
    refuses(["--dead-time-us", "500", "--frequency", "500"], "leaves no pattern of 7 pulses", folder, "no room")
    refuses(["rec.csv"], "rec.csv", folder, "an argument")
    refuses(["--motor", "none.toml"], "none.toml", folder, "a motor file that is not there")


def simulated(folder):
    motor, scenario = (program.ROOT / "data" / name for name in ("motors/jarzebowicz2019.toml", "scenarios/pulse_pattern.toml"))
    simulate = ["simulate", "--motor", motor, "--scenario", scenario, "-o"]
    done = program.run([*simulate, "r.csv"], folder)
    lines = (folder / "r.csv").read_text().splitlines() if done.returncode == 0 else [""]
    check(lines[1:2] == ['# [control] modulation = "pattern", pulses = 5'], f"the recording says what it is: {done.stderr}")
    for command, arguments, words in (
            ("diagnose", ["r.csv", "--motor", motor], b"rows of a pulse pattern (5 pulses) cannot be diagnosed"),
            ("an effect on duties", [*simulate[1:], "x.csv", "--effect", "glitch"], b"has no duties"),
            ("an emulated target", [*simulate[1:], "x.csv", "--target", "rv32"], b"runs pulse patterns"),
            ("an FMU", [*simulate[1:], "x.fmu"], b"runs pulse patterns")):
        name = {"diagnose": "diagnose", "an FMU": "export-fmu"}.get(command, "simulate")
        done = program.run([name, *arguments], folder)
        check(done.returncode == 2 and words in done.stderr and done.stderr.count(b"\n") == 1, f"{command}: {done.stderr}")
    for pulses in (1, 2, 4, 17):
        (folder / "p.csv").write_text("\n".join([lines[0], f'# [control] modulation = "pattern", pulses = {pulses}', *lines[2:]]) + "\n")
        done = program.run(["diagnose", "p.csv", "--motor", motor], folder)
        check(done.returncode == 2 and b"pulses = an odd number from 3 to 15" in done.stderr, f"a recording of {pulses} pulses: {done.stderr}")


def effects_in_six_step(folder):
    """An inverter state for each cycle is given by duties: effects on them act."""
    motor = program.ROOT / "data/motors/jarzebowicz2019.toml"
    (folder / "s.toml").write_text('name = "s"\n[control]\nmodulation = "six_step"\nbandwidth_Hz = 100\n[[run]]\nduration_s = 0.02\nu_dc_V = 565\n'
                                   'speed_rpm = 5000\ni_q_A = 4\n')
    rows = set()
    for effect in ([], ["--effect", "voltage_delay:cycles=0.5"], ["--effect", "dead_time:compensation=10"]):
        done = program.run(["simulate", "--motor", motor, "--scenario", "s.toml", "-o", "s.csv", *effect], folder)
        check(done.returncode == 0, f"six-step with {effect}: {done.stderr}")
        rows.add("\n".join(line for line in (folder / "s.csv").read_text().splitlines() if not line.startswith("#")))
    check(len(rows) == 3, "each effect changes the recording")


def main():
    with tempfile.TemporaryDirectory() as name:
        for part in (compare, with_motor, write, several, refuse, simulated, effects_in_six_step):
            part(pathlib.Path(name))
    print(f"{len(failures)} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
