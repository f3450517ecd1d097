#!/usr/bin/env python3
"""
front_page.py IQFOC: every command of the front page and of the tutorials does what the page says, in a folder like a fresh clone.

A console block's lines that begin with `$ ` are run in a row by the shell; where lines follow them, they are what the last one
prints. Blocks that the figures fill are compared by tools/figures.py.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = ("docs/index.md", "docs/first-drive.md", "docs/own-log.md")


def blocks(page):
    """(commands, lines that the last one prints) of each console block."""
    page = re.sub(r"<!-- figures:.*?<!-- end -->", "", page, flags=re.DOTALL)
    for text in re.findall(r"^```console\n(.*?)^```", page, re.MULTILINE | re.DOTALL):
        lines = text.rstrip("\n").split("\n")
        yield [line[2:] for line in lines if line.startswith("$ ")], [line for line in lines if not line.startswith("$ ")]


def blocks_of(page):
    found = list(blocks((ROOT / page).read_text(encoding="utf-8")))
    if not found:
        sys.exit(f"{page} has lost its commands")
    return found


def main(program):
    found = [block for page in PAGES for block in blocks_of(page)]
    failed = 0
    with tempfile.TemporaryDirectory(prefix="iqfoc-front-") as folder:
        here = pathlib.Path(folder)
        for entry in ROOT.iterdir():
            if entry.name not in ("build", ".git", ".cache"):
                (here / entry.name).symlink_to(entry)
        (here / "build/host").mkdir(parents=True)
        (here / "build/host/iqfoc").symlink_to(pathlib.Path(program).resolve())
        for commands, expected in found:
            printed = ""
            for command in commands:
                done = subprocess.run(["bash", "-c", command], cwd=here, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                                      check=False, env={**os.environ, "CMAKE_GENERATOR": "Ninja"})
                printed = done.stdout
                if done.returncode != 0:
                    failed += 1
                    print(f"{command}\nended with {done.returncode}: {(done.stdout + done.stderr)[-2000:]}")
            if expected and printed.rstrip().split("\n") != expected:
                failed += 1
                print(f"{commands[-1]}\nprints\n{printed}\nand not, as the page says,\n" + "\n".join(expected))
        report = here / "build/diagnosis/report.html"
        if not report.is_file() or "dead_time" not in report.read_text(encoding="utf-8"):
            failed += 1
            print("build/diagnosis/report.html does not name the dead time")
    print(f"{len(found)} blocks, {failed} failures")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
