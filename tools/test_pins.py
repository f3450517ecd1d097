#!/usr/bin/env python3
"""Every download of the tree has a hash in the tree, except Debian's packages, which apt's signatures protect."""

import pathlib
import re
import subprocess
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
HASH = re.compile(r"[0-9a-f]{64}")
# The files that may fetch something, and the allowed commands.
SCRIPTS = re.compile(r"(^|/)(dev|run|CMakeLists\.txt|[^/]+\.(sh|py|cmake))$")
FETCHES = re.compile(r"pip\"? +(install|download|wheel) (?!iqfoc)|npm +(install|ci|exec)|npx |\bcurl |\bwget |git clone|GIT_REPOSITORY|"
                     r"file\(DOWNLOAD|ExternalProject_Add|urlretrieve|requests\.get")
PINNED = ("--require-hashes", "--no-index", "--no-build-isolation --no-deps")


def tree():
    """The scripts of the tree but for this one, {path: text} with continued lines joined."""
    names = subprocess.run(["git", "ls-files"], cwd=ROOT, check=True, capture_output=True, text=True).stdout.split("\n")
    return {name: (ROOT / name).read_text(encoding="utf-8").replace("\\\n", " ") for name in names
            if SCRIPTS.search(name) and (ROOT / name).is_file() and name != "tools/test_pins.py"}


def unpinned(text):
    return [line.strip() for line in text.split("\n") if FETCHES.search(line) and not any(word in line for word in PINNED)]


class Pins(unittest.TestCase):
    def test_scripts(self):
        scripts = tree()
        self.assertIn("dev", scripts)
        self.assertIn("tools/setup.sh", scripts)
        self.assertGreater(sum(len(FETCHES.findall(text)) for text in scripts.values()), 3)
        self.assertEqual({}, {name: unpinned(text) for name, text in scripts.items() if unpinned(text)})

    def test_that_a_fetch_is_seen(self):
        for line in ("pip install numpy", "\"$place/bin/pip\" install --quiet numpy", "curl -O https://example.org/a.tar.gz",
                     "FetchContent_Declare(x GIT_REPOSITORY y)", "npm install -g uplot"):
            self.assertEqual([line], unpinned(line), line)

    def test_python(self):
        files = sorted((ROOT / "packages/python").glob("*.txt"))
        self.assertGreater(len(files), 3)
        for file in files:
            text = file.read_text(encoding="utf-8").replace("\\\n", " ")
            for line in (line for line in text.split("\n") if line.strip() and not line.strip().startswith("#")):
                self.assertRegex(line, r"^[\w.\[\]-]+==\S+ .*--hash=sha256:[0-9a-f]{64}", f"{file.name}: {line}")

    def test_npm(self):
        setup = (ROOT / "tools/setup.sh").read_text(encoding="utf-8")
        self.assertEqual(1, setup.count("npm pack"))
        packages = re.findall(r"set_up_npm ([\w-]+)@", setup)
        self.assertGreater(len(packages), 1)
        for name in [*packages, "unity"]:
            lines = (ROOT / f"packages/{name}.sha256").read_text(encoding="utf-8").split("\n")
            self.assertTrue(all(HASH.match(line) for line in lines if line), name)


if __name__ == "__main__":
    unittest.main()
