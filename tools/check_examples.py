#!/usr/bin/env python3
"""Compiles every ```c block of README.md against the library's headers, for the host and for Cortex-M4.

Each block has to be a whole translation unit, as a reader would paste it into a file.
"""

import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
FLAGS = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wstrict-prototypes", "-Werror",
         "-O2", "-c"]
COMPILERS = [
    ["gcc"],
    ["clang"],
    ["arm-none-eabi-gcc", "-mcpu=cortex-m4", "-mthumb", "-ffreestanding"],
]


def c_blocks(text):
    """(line number, source) of each fenced C block."""
    for match in re.finditer(r"^```c\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        yield text.count("\n", 0, match.start(1)) + 1, match.group(1)


def main():
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
            for compiler in COMPILERS:
                command = [*compiler, *FLAGS, f"-I{ROOT / 'include'}", str(file), "-o", str(file.with_suffix(".o"))]
                done = subprocess.run(command, check=False)
                print(f"README.md:{line}: {compiler[0]}: {'ok' if done.returncode == 0 else 'does not compile'}",
                      flush=True)
                failures += done.returncode != 0
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
