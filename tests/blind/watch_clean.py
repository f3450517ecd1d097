"""Clean cycles for the watch, in chunks that add up: drives of varied duty in which nothing changes, until a number of cycles is reached.

    tests/blind/watch_clean.py [--cycles 1e8] [--seconds S] [--results tests/blind/watch_clean.jsonl] [--iqfoc PROGRAM]

Each chunk is a line of the results: its seed, its cycles, alarms, and how often each level was passed. A chunk that is there already is
not run again, so that a run may be ended and resumed at will; --seconds begins no new chunk after that time. Chunks of another library
(each line has its golden hash) are dropped. Exit status 1 if there is an alarm.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
MOTOR = "data/motors/compressor_salient.toml"
CHUNK = 2_000_000
# Seeds that a chunk uses up: one for each million of cycles.
SEEDS = 2


def chunk(program, number, golden):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out.json"
        seed = 2_000_000 + SEEDS * number
        subprocess.run([program, "watch", "--motor", MOTOR, "--trials", "0", "--condition", "constant", "--cycles", str(CHUNK), "--seed", str(seed), "--json", out],
                       cwd=ROOT, check=True, capture_output=True)
        found = json.loads(out.read_text(encoding="utf-8"))["clean"]
    return {"chunk": number, "seed": seed, "cycles": found["cycles"], "alarms": found["alarms"], "highest": found["highest"],
            "passed": found["passed"], "golden": golden}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cycles", type=float, default=1e8)
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--results", type=pathlib.Path, default=ROOT / "tests" / "blind" / "watch_clean.jsonl")
    parser.add_argument("--iqfoc", type=pathlib.Path, default=ROOT / "build" / "host" / "iqfoc")
    options = parser.parse_args()
    program, end = options.iqfoc.resolve(), time.monotonic() + options.seconds
    golden = subprocess.run([program, "golden"], check=True, capture_output=True, text=True).stdout.split()[-1]
    lines = options.results.read_text(encoding="utf-8").splitlines() if options.results.exists() else []
    done = {run["chunk"]: run for run in map(json.loads, lines) if run["golden"] == golden}
    number = 0
    while sum(run["cycles"] for run in done.values()) < options.cycles and time.monotonic() < end:
        if number not in done:
            done[number] = chunk(program, number, golden)
            options.results.write_text("".join(json.dumps(done[n]) + "\n" for n in sorted(done)), encoding="utf-8")
        number += 1
    alarms = sum(run["alarms"] for run in done.values())
    print(f"{sum(run['cycles'] for run in done.values()):.3g} cycles, {alarms} alarms, the highest detector at "
          f"{max(run['highest'] for run in done.values()):.2f}")
    return 1 if alarms else 0


if __name__ == "__main__":
    sys.exit(main())
