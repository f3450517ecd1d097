#!/usr/bin/env python3
"""Compiles every ```c block of README.md as C99 and as C++20, for the host and for Cortex-M4, and runs the drive in it.

Each block has to be a whole translation unit, as a reader would paste it into a file. tests/consume/readme_drive.c is linked to it: the
drive must start with its gates off, and trip on a late, missed, stale or excessive sample.
--quick: without clang.
"""

import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
FLAGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror", "-O2", f"-I{ROOT / 'include'}"]
C99 = ["-std=c99", "-Wstrict-prototypes"]
CPP20 = ["-x", "c++", "-std=c++20"]
COMPILERS = [
    ["gcc", *C99],
    ["clang", *C99],
    ["arm-none-eabi-gcc", "-mcpu=cortex-m4", "-mthumb", "-ffreestanding", *C99],
    ["g++", *CPP20],
    ["clang++", *CPP20],
]
DRIVE = ROOT / "tests/consume/readme_drive.c"


def c_blocks(text):
    """(line number, source) of each fenced C block."""
    for match in re.finditer(r"^```c\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        yield text.count("\n", 0, match.start(1)) + 1, match.group(1)


def run_drive(example, folder):
    """The exit status of the example's drive on a board that is late, misses a peak, and so on."""
    program = folder / "drive"
    sources = [str(example), str(DRIVE), *map(str, sorted((ROOT / "src").glob("*.c")))]
    built = subprocess.run(["gcc", *C99, *FLAGS, *sources, "-o", str(program)], check=False)
    return built.returncode or subprocess.run([program], check=False).returncode


def main():
    compilers = [compiler for compiler in COMPILERS if "--quick" not in sys.argv or not compiler[0].startswith("clang")]
    readme = ROOT / "README.md"
    blocks = list(c_blocks(readme.read_text(encoding="utf-8"))) if readme.exists() else []
    if not blocks:
        print("README.md: no ```c block, so that nothing shows how firmware calls the library")
        return 1
    failures = 0
    with tempfile.TemporaryDirectory() as folder:
        for line, source in blocks:
            file = pathlib.Path(folder) / "example.c"
            # The compiler then names README.md and its line.
            file.write_text(f'#line {line} "README.md"\n{source}', encoding="utf-8")
            for compiler in compilers:
                command = [*compiler, *FLAGS, "-c", str(file), "-o", str(file.with_suffix(".o"))]
                done = subprocess.run(command, check=False)
                print(f"README.md:{line}: {compiler[0]}: {'ok' if done.returncode == 0 else 'does not compile'}",
                      flush=True)
                failures += done.returncode != 0
            wrong = run_drive(file, file.parent)
            print(f"README.md:{line}: its drive: {'ok' if wrong == 0 else f'check {wrong} failed'}", flush=True)
            failures += wrong != 0
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
