#!/usr/bin/env python3
"""
The watch's whole chain on an emulated Cortex-M4: the firmware drives the plant under the tuned controller, something about the drive
changes, its watch notes that within a second and triggers its recorder, `iqfoc record` reads the dump from the board's UART, and
`iqfoc diagnose` names the cause with its value. One drive of each change, as the host's firmware runs it: the dump is its recording.

Called by tests/target/run.sh; more by tests/blind/watch.py --target cortex-m4 --trials N.
"""
import argparse
import csv
import math
import pathlib
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tests" / "blind"))

import watch

TARGET = "cortex-m4"
SEED = 1
# A second at 8 kHz, what the image's memory holds.
ROWS = 8000
# What 1.0 stands for, by a column's first letter: the rated peak, a turn, a turn per cycle, a duty, the link. A value on the target is
# rounded to 2^-24 of it.
UNITS = {"i": 6 * 2 ** 0.5, "t": math.tau, "o": math.tau * 8000, "d": 1, "u": 565}

failures = []


def check(good, what):
    print(("ok    " if good else "FAIL  ") + what)
    if not good:
        failures.append(what)


def columns_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(line for line in file if not line.startswith("#"))
    return {name: [float(row[k]) for row in rows] for k, name in enumerate(head)}


def same_dump(program, folder):
    """The target's recorder against the host's drive of the same seed: from the first row on, every column."""
    recordings = []
    for target in (None, TARGET):
        place = folder / str(target)
        outcome = watch.noted(program, "winding", SEED, place, target)
        if outcome != "resistance":
            check(False, f"{target or 'host'}: winding: {outcome}")
            return
        recordings.append(columns_of(place / "rec.csv"))
    here, there = recordings
    shared = sorted((set(here) & set(there)) - {"t_s", "run"})
    rows = min(len(here["t_s"]), len(there["t_s"]))
    # The alarm's own row is the dump's first; the host's recording begins with the next.

    def difference(name, a, b):
        """In LSB of IQ24; angles but for whole turns."""
        units = (a - b) / UNITS[name[0]]
        return abs(units - (round(units) if name[0] == "t" else 0)) * 2 ** 24

    apart = max(difference(name, a, b) for name in shared for a, b in zip(here[name], there[name][1:]))
    check(rows >= ROWS - 1 and len(shared) >= 9 and apart <= 1,
          f"{TARGET}: {rows} rows of {', '.join(shared)} as on the host, {apart:.2f} LSB apart at most")


def main():
    parser = argparse.ArgumentParser(description=__doc__.strip().split("\n", maxsplit=1)[0])
    parser.add_argument("--build", type=pathlib.Path, required=True)
    options = parser.parse_args()
    program = (options.build / "host" / "iqfoc").resolve()
    with tempfile.TemporaryDirectory(prefix="iqfoc-watch-") as name:
        folder = pathlib.Path(name)
        same_dump(program, folder)
        for change in watch.CHANGES:
            outcome = watch.trial(program, change, SEED, folder / change, TARGET)
            check(outcome == "named", f"{TARGET}: {change}: {outcome}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
