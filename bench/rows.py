#!/usr/bin/env python3
"""Processor time and peak memory of `iqfoc diagnose` against the rows of a recording.

    bench/rows.py                       2,000, 15,000, 90,000 and 500,000 rows: a table, and the exponent of time over rows
    bench/rows.py --rows 32000,128000 --one-run --most 1.2     fails if the exponent of processor time is larger
    bench/rows.py --most-bytes 640      fails if the peak memory grows by more bytes a row between the largest two sizes

The recordings are simulated: a salient drive with a dead time and a warm winding at six operating points, stepped in both currents.
"""

import argparse
import math
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
MOTOR = ROOT / "data" / "motors" / "compressor_salient.toml"
EFFECTS = ["dead_time:t_dead=2e-6", "resistance:R=1.05"]
POINTS = [(0, 3.0), (300, 4.0), (900, 6.0), (-1500, 5.0), (2200, 7.0), (3000, 4.0)]  # rpm, A


def scenario(rows, points):
    """Runs of equal length at the operating points."""
    lines = ['name = "rows"', "[sensors]", "current_bits = 12", "current_full_scale_A = 25", "current_noise_A = 0.025", "[log]",
             "duties = true"]
    for rpm, i_q in points:
        lines += ["[[run]]", f"cycles = {rows // len(points)}", f"speed_rpm = {rpm}",
                  "i_d_A = { value = -1.0, square = { amplitude = 0.5, period_s = 0.023 } }",
                  f"i_q_A = {{ value = {i_q}, square = {{ amplitude = 1.0, period_s = 0.031 }} }}"]
    return "\n".join(lines) + "\n"


def diagnose(iqfoc, folder):
    """Seconds on the processor and peak memory in MB of one diagnosis."""
    process = subprocess.Popen([iqfoc, "diagnose", "rec.csv", "--motor", str(MOTOR), "--json", "out.json"], cwd=folder,
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    problem = process.stderr.read().decode()
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise RuntimeError(f"iqfoc diagnose, exit {process.returncode}: {problem.strip()}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024.0


def measure(iqfoc, rows, points):
    with tempfile.TemporaryDirectory(prefix="rows-") as name:
        folder = pathlib.Path(name)
        (folder / "scenario.toml").write_text(scenario(rows, points), encoding="utf-8")
        command = [iqfoc, "simulate", "--motor", str(MOTOR), "--scenario", "scenario.toml", "-o", "rec.csv", "--seed", "5"]
        for effect in EFFECTS:
            command += ["--effect", effect]
        subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
        return diagnose(iqfoc, folder)


def exponent(rows, seconds):
    """Slope of the line through the points in logarithms."""
    x, y = [math.log(r) for r in rows], [math.log(s) for s in seconds]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--iqfoc", default=str(ROOT / "build" / "host" / "iqfoc"))
    parser.add_argument("--rows", default="2000,15000,90000,500000", help="sizes, by commas")
    parser.add_argument("--one-run", action="store_true", help="all rows in one run at one operating point")
    parser.add_argument("--most", type=float, help="fail if the exponent of the largest two sizes is larger")
    parser.add_argument("--most-bytes", type=float, help="fail if the largest two sizes need more bytes of memory a row")
    args = parser.parse_args()
    rows = [int(r) for r in args.rows.split(",")]
    if len(rows) < 2 or min(rows) < 1200 or sorted(set(rows)) != rows:
        parser.error("--rows: two sizes or more of 1,200 rows or more, in ascending order")
    iqfoc, seconds, peak = os.path.abspath(args.iqfoc), [], []
    print("| rows | processor time | peak memory |\n| --- | --- | --- |")
    for n in rows:
        taken, memory = measure(iqfoc, n, POINTS[3:4] if args.one_run else POINTS)
        seconds.append(taken)
        peak.append(memory)
        print(f"| {n} | {taken:.2f} s | {memory:.0f} MB |", flush=True)
    found = exponent(rows[-2:], seconds[-2:])
    print(f"Exponent of processor time over rows: {exponent(rows, seconds):.2f}, of the largest two {found:.2f}.")
    each = (peak[-1] - peak[-2]) * 2 ** 20 / (rows[-1] - rows[-2])
    print(f"Peak memory grows by {each:.0f} bytes a row between the largest two sizes.")
    too_much = [most for most, value in ((args.most, found), (args.most_bytes, each)) if most is not None and value > most]
    for most in too_much:
        print(f"above {most:g}")
    return 1 if too_much else 0


if __name__ == "__main__":
    sys.exit(main())
