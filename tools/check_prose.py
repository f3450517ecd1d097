#!/usr/bin/env python3
"""Checks the line width of README.md and docs/: no line of prose is longer than 138 characters.

    check_prose.py          names each line that is; exit status 1 if there is one

Tables, code, console output, comments and the blocks that programs write (<!-- figures: ... -->, <!-- blind: ... -->, <!-- bench: ... -->)
may have any width.
"""

import pathlib
import re
import sys

WIDTH = 138
ROOT = pathlib.Path(__file__).resolve().parent.parent
BLOCK = re.compile(r"<!-- (figures|blind|bench): .*-->")
END = re.compile(r"<!-- (bench: )?end -->")


def prose(text):
    """(line number, line) of each line that is prose."""
    in_fence = in_block = False
    for number, line in enumerate(text.split("\n"), 1):
        if line.startswith("```"):
            in_fence = not in_fence
        elif in_fence:
            continue
        elif END.fullmatch(line):
            in_block = False
        elif BLOCK.fullmatch(line):
            in_block = True
        elif not in_block and not line.startswith(("|", "    ", "<!--")):
            yield number, line


def too_long(text):
    return [(number, len(line)) for number, line in prose(text) if len(line) > WIDTH]


def documents(root):
    return [root / "README.md", *sorted((root / "docs").glob("**/*.md"))]


def main(root=ROOT, out=sys.stdout):
    found = 0
    for file in documents(root):
        for number, length in too_long(file.read_text(encoding="utf-8")):
            print(f"{file.relative_to(root)}:{number}: {length} characters, at most {WIDTH} are allowed", file=out)
            found += 1
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
