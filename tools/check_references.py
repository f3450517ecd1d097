#!/usr/bin/env python3
"""Checks the references of README.md and docs/: files, links, and names of the C code must exist.

    check_references.py     names each broken reference; exit status 1 if there is one

Checked are relative links; in `code spans` the paths and the names of sources (`src/cycle.c`, `rows.h`, `sim_host/model/averaged*`);
and everywhere the identifiers that begin with iqfoc_, IQFOC_ or IQ24_. Files that a user has or a program writes are no sources.
"""

import pathlib
import posixpath
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LINK = re.compile(r"\]\(([^)#\s]+)[^)]*\)")
SPAN = re.compile(r"`([^`\n]+)`")
PATH = re.compile(r"(?:[\w.-]+/)+[\w.*-]*|[\w-]+\.(?:c|h|cpp|def|py|sh)")
NAME = re.compile(r"\b(?:iqfoc_|IQFOC_|IQ24_)\w*\w")
SOURCE = (".c", ".h", ".cpp", ".def", ".py", ".sh")
NOT_SOURCES = {"iqfoc_extension.h", "iqfoc_tuned.h", "unity.c"}
# Variables of ./dev, and what a diagnosis and a design write for a firmware.
NOT_IN_C = re.compile(r"IQFOC_JOBS|IQFOC_NO_INSTALL|IQFOC_DIAGNOSED_\w+|iqfoc_extension|iqfoc_tuned")


class Tree:
    """The tracked files, their folders, and the identifiers of the C code and of CMake."""

    def __init__(self, root):
        listed = subprocess.run(["git", "ls-files"], cwd=root, check=True, capture_output=True, text=True).stdout
        self.files = {file for file in listed.splitlines() if (root / file).exists()}
        self.folders = {str(folder) for file in self.files for folder in pathlib.PurePosixPath(file).parents}
        self.names = set()
        for file in self.files:
            if file.endswith((".c", ".h", ".cpp", ".cmake", "CMakeLists.txt")):
                self.names |= set(NAME.findall((root / file).read_text(encoding="utf-8")))

    def has(self, path):
        """A path from the root, with * in it; or the end of a source's path, if only its name."""
        pattern = re.compile(re.escape(posixpath.normpath(path)).replace(r"\*", "[^/]*"))
        if any(pattern.fullmatch(known) for known in self.files | self.folders):
            return True
        return path.endswith(SOURCE) and any(re.fullmatch(f".*/{pattern.pattern}", file) for file in self.files)

    def is_its_own(self, path):
        """Is a path one of this tree? `DIR/summary.json` and `build/host` are not."""
        return path.endswith(SOURCE) or path.split("/")[0] in self.folders


def missing(text, folder, tree):
    """(line number, reference) of each that leads nowhere, in a document of this folder."""
    in_fence = False
    for number, line in enumerate(text.split("\n"), 1):
        if line.startswith("```"):
            in_fence = not in_fence
        for name in NAME.findall(line):
            if name not in tree.names and not NOT_IN_C.fullmatch(name):
                yield number, name
        if in_fence or line.startswith("    "):
            continue
        for target in LINK.findall(line):
            path = posixpath.normpath(posixpath.join(folder, target))
            if "://" not in target and path not in tree.files | tree.folders:
                yield number, target
        for span in SPAN.findall(line):
            if PATH.fullmatch(span) and posixpath.basename(span) not in NOT_SOURCES and tree.is_its_own(span) and not tree.has(span):
                yield number, span


def main(root=ROOT, out=sys.stdout):
    tree = Tree(root)
    found = 0
    for file in sorted(file for file in tree.files if re.fullmatch(r"README\.md|docs/.*\.md", file)):
        for number, reference in missing((root / file).read_text(encoding="utf-8"), posixpath.dirname(file), tree):
            print(f"{file}:{number}: {reference} is not in the tree", file=out)
            found += 1
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
