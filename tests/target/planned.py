#!/usr/bin/env python3
"""
Test of a planned recording by the firmware. The header in examples/planned_recording is the one that `iqfoc plan` writes. The image that
follows it on an emulated Cortex-M4 makes the same recording as `iqfoc simulate` with the scenario next to it, byte for byte.

Called by tests/target/run.sh.
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
MOTOR = ROOT / "data" / "motors" / "jarzebowicz2019.toml"
HEADER = ROOT / "examples" / "planned_recording" / "iqfoc_plan.h"
SECONDS = "1.5"


def main():
    parser = argparse.ArgumentParser(description=__doc__.strip().split("\n", maxsplit=1)[0])
    parser.add_argument("--build", type=pathlib.Path, required=True)
    options = parser.parse_args()
    program = options.build / "host" / "iqfoc"
    image = options.build / "cortex-m4" / "examples" / "planned_recording.elf"
    with tempfile.TemporaryDirectory(prefix="iqfoc-planned-") as name:
        folder = pathlib.Path(name)

        def run(*words):
            subprocess.run([str(word) for word in (program, *words)], check=True, capture_output=True)

        run("plan", "--motor", MOTOR, "--seconds", SECONDS, "-o", folder / "plan.toml", "--firmware", folder / "iqfoc_plan.h")
        simulate = ("simulate", "--motor", MOTOR, "--scenario", folder / "plan.toml", "-o")
        run(*simulate, folder / "host.csv")
        run(*simulate, folder / "target.csv", "--target", "cortex-m4", "--image", image)
        rows = (folder / "host.csv").read_bytes().count(b"\n") - 2
        results = {f"{HEADER.relative_to(ROOT)} is what iqfoc plan writes":
                   (folder / "iqfoc_plan.h").read_bytes() == HEADER.read_bytes(),
                   f"{rows} cycles by the target's own references are the simulated ones":
                   rows > 1000 and (folder / "target.csv").read_bytes() == (folder / "host.csv").read_bytes()}
    for words, good in results.items():
        print(("ok    " if good else "FAIL  ") + words)
    return 0 if all(results.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
