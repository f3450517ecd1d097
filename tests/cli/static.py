#!/usr/bin/env python3
"""The statically linked programs: they are that, have the golden vectors, and diagnose as the machine's own program to the last digit.

    tests/cli/static.py NATIVE STATIC...        run by ./dev test --all; those for another processor under qemu-user
"""

import gzip
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROWS = 3000  # of a recording: QEMU takes its time


def runner(path):
    kind = subprocess.run(["file", "--brief", path], capture_output=True, text=True, check=True).stdout
    assert "statically linked" in kind, f"{path}: {kind}"
    return (["qemu-aarch64-static"] if "aarch64" in kind else []) + [path]


def done(command):
    return subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout


def diagnosis(command, folder):
    """The JSON, with the recording's packed half read by the program's own zlib."""
    out = folder / "diagnosis.json"
    done([*command, "diagnose", folder / "short.csv.gz", "--motor", "data/recordings/sensor_gain.toml", "--json", out])
    return out.read_text()


def main():
    native, *programs = sys.argv[1:]
    assert programs, __doc__
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        with gzip.open(ROOT / "data/recordings/sensor_gain.csv.gz", "rt") as whole, gzip.open(folder / "short.csv.gz", "wt") as short:
            for _, line in zip(range(ROWS), whole):
                short.write(line)
        expected = diagnosis([native], folder)
        assert '"id": "current_gain"' in expected or '"causes": [' in expected, expected
        golden = done([native, "golden"])
        for program in programs:
            command = runner(program)
            assert done([*command, "golden"]) == golden, program
            assert diagnosis(command, folder) == expected, f"{program}: the diagnosis differs from the native program's"
            print(f"ok    {program}: {golden.strip()}, {len(expected)} characters of JSON alike")
    return 0


if __name__ == "__main__":
    sys.exit(main())
