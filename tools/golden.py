#!/usr/bin/env python3
"""Compares the hash over all golden vectors in each place that is built: docs/golden.md.

    golden.py check     asks each place that is built; exit status 1 where one shows another hash
    golden.py write     writes the page's table of places

The hash is golden_hash.c's, over the digests of every function and every configuration of the cycle. Places that print the digests
one by one (the emulated boards, in build/same_bits/) have it computed here from what they printed.
"""

import pathlib
import re
import shutil
import subprocess
import sys

from marked import with_table

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/golden.md"
BUILD = ROOT / "build"
# Those that every run of the tests builds ahead of this.
ALWAYS = 4
MASK = 2**64 - 1
DIGEST_START, DIGEST_FACTOR = 0xCBF29CE484222325, 0x100000001B3


def expected():
    text = (ROOT / "tests/target/golden/golden_hash.h").read_text(encoding="utf-8")
    return int(re.search(r"#define GOLDEN_HASH UINT64_C\((0x[0-9a-f]+)\)", text)[1], 16)


def add(digest, number):
    """digest.h's digest_add."""
    digest = ((digest ^ number) * DIGEST_FACTOR) & MASK
    return digest ^ digest >> 29


def hash_of(listing):
    """The hash of the digests in a listing, down to the closed loop's, which is no golden vector."""
    state = DIGEST_START
    for line in listing.split("\n"):
        if line.startswith("closed_loop "):
            return state
        name, digest = line.split()
        for letter in name.encode():
            state = add(state, letter)
        state = add(add(state, int(digest, 16) >> 32), int(digest, 16) & 0xFFFFFFFF)
    raise ValueError("no closed_loop behind the digests")


def printed(*command):
    """A function that runs a command and returns the hash it prints behind `golden`, or None where it is not built."""
    def ask():
        if not all(pathlib.Path(word).exists() for word in command if str(word).startswith(str(ROOT))):
            return None
        if shutil.which(str(command[0])) is None:
            return None
        done = subprocess.run(command, capture_output=True, text=True, check=False, cwd="/")
        found = re.search(r"^golden ([0-9a-f]{16})$", done.stdout, re.MULTILINE)
        return int(found[1], 16) if found else 0
    return ask


def listed(name):
    """The same for a place whose digests are in build/same_bits."""
    def ask():
        file = BUILD / "same_bits" / f"{name}.txt"
        return hash_of(file.read_text(encoding="utf-8")) if file.exists() else None
    return ask


def written(file):
    """The same for a place that only a test can ask, which keeps what it read in a file of the build."""
    def ask():
        path = BUILD / file
        return int(path.read_text(encoding="utf-8").split()[1], 16) if path.exists() else None
    return ask


OF_FMU = """import fmpy, subprocess, sys, tempfile
with tempfile.TemporaryDirectory() as folder:
    path = folder + "/drive.fmu"
    subprocess.run([sys.argv[1], "export-fmu", "--motor", sys.argv[2], "-o", path], check=True)
    table = fmpy.simulate_fmu(path, stop_time=1e-3, output_interval=1e-3, output=["golden_hash"])
    print("golden %016x" % table["golden_hash"][0])
"""


# Place, how it is asked, what holds it to the hash in CI, and the function that asks.
PLACES = (
    ("Linux on x86-64, gcc and clang", "`iqfoc golden`", "`tests/cli/help.py`, part `target`", printed(BUILD / "host/iqfoc", "golden")),
    ("Cortex-M4", "`same_bits` on QEMU's mps2-an386", "part `target`", listed("cortex-m4")),
    ("Cortex-M0+", "its code on the same board", "part `target`", listed("cortex-m0plus")),
    ("RV32IM", "`same_bits` on QEMU's virt", "part `target`", listed("rv32")),
    ("Linux on x86-64, static", "`iqfoc golden`", "part `static`", printed(BUILD / "static-x86-64/iqfoc", "golden")),
    ("Linux on arm64, static", "the same under qemu-user", "part `static`",
     printed("qemu-aarch64-static", BUILD / "static-arm64/iqfoc", "golden")),
    ("Python wheel", "`iqfoc.golden()`", "`python/tests/test_functions.py`",
     printed(BUILD / "wheel/fresh/bin/python", "-c", "import iqfoc; print('golden', iqfoc.golden())")),
    ("WebAssembly", "the page's button", "`tests/browser/web_page.py`", written("web/golden.txt")),
    ("FMU", "its variable `golden_hash`, by FMPy", "`tests/cli/fmu.py`",
     printed(ROOT / ".cache/python/fmpy/bin/python", "-B", "-c", OF_FMU, BUILD / "host/iqfoc", ROOT / "data/motors/jarzebowicz2019.toml")),
)


def table():
    """The header's name stands for the number; tools/site/build.py puts the number there."""
    lines = ["| place | hash | asked by | held by |", "| --- | --- | --- | --- |"]
    lines += [f"| {name} | `GOLDEN_HASH` | {how} | {test} |" for name, how, test, _ in PLACES]
    return "\n".join(lines)


def main():
    task = sys.argv[1] if len(sys.argv) == 2 else ""
    if task not in ("write", "check"):
        print("expected write or check", file=sys.stderr)
        return 2
    page = PAGE.read_text(encoding="utf-8")
    now = with_table(page, "golden", table())
    if task == "write":
        PAGE.write_text(now, encoding="utf-8")
        return 0
    want = expected()
    said = [ask() for _, _, _, ask in PLACES]
    for (name, _, _, _), value in zip(PLACES, said):
        print(f"{'not built       ' if value is None else f'{value:016x}'}  {name}")
    if any(value is None for value in said[:ALWAYS]):
        print(f"the first {ALWAYS} must be built: ./dev build, tests/target/run.sh")
    elif any(value not in (None, want) for value in said):
        print(f"{want:016x} is expected of all")
    elif now != page:
        print("docs/golden.md names other places; tools/golden.py write writes it")
    else:
        return 0
    return 1


if __name__ == "__main__":
    sys.exit(main())
