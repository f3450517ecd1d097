#!/usr/bin/env python3
"""What a second worker brings: time and processor time of fleet.py with one worker and with two, in turn.

    workers.py FOLDER [--repeat 3] [--workers 1,2]

FOLDER is one that make.py made. Times by the clock mean something on an idle machine only; the processor time is also right on a busy one.
"""

import argparse
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

SAID = re.compile(r"(\d+) recordings in ([\d.]+) s, ([\d.]+) s of")


def measure(folder, workers):
    """(recordings, seconds by the clock, seconds of the workers' processor time) of one run."""
    with tempfile.TemporaryDirectory(prefix="fleet-") as out:
        command = [sys.executable, pathlib.Path(__file__).with_name("fleet.py"), folder, "-o", out, "--workers", str(workers)]
        said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    count, took_s, used_s = SAID.match(said).groups()
    return int(count), float(took_s), float(used_s)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--workers", default="1,2")
    args = parser.parse_args()
    runs = {int(n): [] for n in args.workers.split(",")}
    busy = os.getloadavg()[0]
    for _ in range(args.repeat):
        for workers, found in runs.items():
            found.append(measure(args.folder, workers))
    print(f"{next(iter(runs.values()))[0][0]} recordings, {os.cpu_count()} cores, load before the first run {busy:.1f}; medians of {args.repeat}")
    first_s = None
    for workers, found in runs.items():
        took_s = statistics.median(took for _, took, _ in found)
        used_s = statistics.median(used for _, _, used in found)
        first_s = first_s or took_s
        print(f"{workers} workers: {took_s:.1f} s, {used_s:.1f} s of processor time, {first_s / took_s:.2f} times as fast as the first")


if __name__ == "__main__":
    main()
