#!/usr/bin/env python3
"""Keeps the figures in README.md and docs/ equal to the program's results.

    figures.py check        prints the blocks that differ from the program's output; exit status 1 if any does
    figures.py write        rewrite them
    figures.py write front  those of one generator only

A block of a Markdown file between

    <!-- figures: NAME ARGUMENTS... -->
    <!-- end -->

holds the output of that generator for these arguments, and nothing else. Generators are in tools/generators/.
A block inside a code fence is an example and is left alone.
"""

import argparse
import difflib
import json
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

from generators import GENERATORS

ROOT = pathlib.Path(__file__).resolve().parent.parent
BEGIN = re.compile(r"<!-- figures: (.+) -->")
END = "<!-- end -->"
# Commands that write a page, if a folder is named.
PAGES = ("diagnose", "loops", "sweep", "tune")


class FigureError(Exception):
    """A block that cannot be filled; its text says where and why."""


class Program:
    """The built iqfoc, run once for each distinct command line."""

    def __init__(self, path, writes=False):
        self.path = path
        self.root = ROOT
        self.writes = writes  # pictures too are rewritten
        self.results = {}
        self.pages = tempfile.TemporaryDirectory()

    def output(self, *command):
        """What a command prints that is run in the root of the tree."""
        try:
            done = subprocess.run(command, cwd=ROOT, check=False, capture_output=True, text=True)
        except OSError as error:
            raise FigureError(f"{command[0]}: {error.strerror}; `./dev build` builds it") from error
        if done.returncode != 0:
            raise FigureError(f"{' '.join(command)}: exit status {done.returncode}: {done.stderr.strip()}")
        return done.stdout

    def written(self, *arguments):
        """The folder DIR that `iqfoc ARGUMENTS -o DIR` writes; what it writes by --json is next to it."""
        if arguments not in self.results:
            folder = pathlib.Path(self.pages.name, str(len(self.results)))
            where = ["-o", str(folder)] if arguments[0] in PAGES else []
            self.output(str(self.path), *arguments, *where, "--json", f"{folder}.json")
            self.results[arguments] = folder
        return self.results[arguments]

    def json(self, *arguments):
        """What `iqfoc ARGUMENTS --json F` writes into F."""
        return json.loads(pathlib.Path(f"{self.written(*arguments)}.json").read_text(encoding="utf-8"))


def generate(words, program):
    """The lines of the block that is headed by these words."""
    name, *arguments = shlex.split(words)
    if name not in GENERATORS:
        raise FigureError(f"no generator is named '{name}'; there are: {', '.join(sorted(GENERATORS))}")
    try:
        return GENERATORS[name](program, arguments).strip("\n").split("\n")
    except (KeyError, ValueError) as error:
        raise FigureError(f"generator {name}: {error}") from error


def fill(text, program, only=None):
    """The text with each block filled, or those of one generator, and the number of blocks."""
    lines, filled, blocks = text.split("\n"), [], 0
    in_fence, number = False, 0
    while number < len(lines):
        line = lines[number]
        filled.append(line)
        number += 1
        if line.startswith("```"):
            in_fence = not in_fence
        match = BEGIN.fullmatch(line)
        if in_fence or not match or (only and shlex.split(match.group(1))[0] != only):
            continue
        try:
            end = lines.index(END, number)
        except ValueError:
            raise FigureError(f"line {number}: no '{END}' after '{line}'") from None
        if any(BEGIN.fullmatch(inner) for inner in lines[number:end]):
            raise FigureError(f"line {number}: another block begins before the '{END}' of '{line}'")
        try:
            filled += ["", *generate(match.group(1), program), "", END]
        except FigureError as error:
            raise FigureError(f"line {number}: {error}") from error
        blocks += 1
        number = end + 1
    return "\n".join(filled), blocks


def documents(root):
    """The Markdown files that may hold blocks."""
    return [file for file in [root / "README.md", *sorted((root / "docs").glob("**/*.md"))] if file.exists()]


def run(mode, root, program, out=sys.stdout, only=None):
    """Checks or writes all documents, or the blocks of one generator in them; the exit status."""
    status = blocks = 0
    for file in documents(root):
        name = file.relative_to(root)
        text = file.read_text(encoding="utf-8")
        try:
            filled, count = fill(text, program, only)
        except FigureError as error:
            print(f"{name}: {error}", file=out)
            status = 1
            continue
        blocks += count
        if filled == text:
            continue
        if mode == "write":
            file.write_text(filled, encoding="utf-8")
            print(f"{name}: rewritten", file=out)
        else:
            out.writelines(difflib.unified_diff(text.splitlines(True), filled.splitlines(True), f"{name} as it is",
                                                f"{name} by the program", n=1))
            status = 1
    if status and mode == "check":
        print("Figures in the documents are not the program's; `./dev figures` rewrites them.", file=out)
    if not blocks and not status:
        print("No document holds a block of figures.", file=out)
        status = 1
    return status


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mode", choices=["check", "write"])
    parser.add_argument("only", nargs="?", choices=sorted(GENERATORS), metavar="GENERATOR", help="its blocks only")
    parser.add_argument("--iqfoc", type=pathlib.Path, default=ROOT / "build" / "host" / "iqfoc")
    options = parser.parse_args()
    return run(options.mode, ROOT, Program(options.iqfoc.resolve(), options.mode == "write"), only=options.only)


if __name__ == "__main__":
    sys.exit(main())
