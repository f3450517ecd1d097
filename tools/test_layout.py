#!/usr/bin/env python3
"""Tests of check_layout.py: it finds an include upwards, a missing arrow, an arrow without an include, a circle, and a missing folder."""

import os
import tempfile
import unittest

import check_layout as layout

MODULES = [("base", "host/base", []), ("data", "host/data", ["base"]), ("top", "host/top", ["base", "data"])]
GOOD = {
    "host/base/error.h": [],
    "host/data/motor.h": ["host/base/error.h"],
    "host/top/main.c": ["host/data/motor.h", "host/base/error.h"],
}


def with_include(file, named):
    graph = {f: list(g) for f, g in GOOD.items()}
    graph[file].append(named)
    return graph


class Layout(unittest.TestCase):
    def one(self, modules, graph, words):
        wrong = layout.compare(modules, graph)
        self.assertTrue(any(words in w for w in wrong), wrong)

    def test_as_drawn(self):
        self.assertEqual([], layout.compare(MODULES, GOOD))

    def test_arrow_up(self):
        self.one(MODULES, with_include("host/base/error.h", "host/top/main.c"), "base <- top: includes a module below it")

    def test_circle(self):
        self.one(MODULES, with_include("host/base/error.h", "host/data/motor.h"), "a circle: ")

    def test_circle_within_a_module(self):
        graph = dict(GOOD, **{"host/base/a.h": ["host/base/b.h"], "host/base/b.h": ["host/base/a.h"]})
        self.assertEqual(["a circle: host/base/a.h -> host/base/b.h -> host/base/a.h"], layout.compare(MODULES, graph))

    def test_not_drawn(self):
        modules = [(n, w, [x for x in names if x != "data"]) for n, w, names in MODULES]
        self.one(modules, GOOD, "top <- data: not in the block: host/top/main.c includes host/data/motor.h")

    def test_drawn_but_not_there(self):
        graph = dict(GOOD, **{"host/data/motor.h": []})
        self.one(MODULES, graph, "data <- base: in the block, but no file includes it")

    def test_no_such_module(self):
        self.one(MODULES + [("attic", "host/attic", ["cellar"])], GOOD, "there is no module cellar")
        self.one(MODULES + [("attic", "host/attic", [])], GOOD, "attic: no file in host/attic")

    def test_longest_path_is_the_module(self):
        modules = MODULES + [("inner", "host/data/inner", [])]
        self.assertEqual("inner", layout.module_of("host/data/inner/x.c", modules))
        self.assertEqual("data", layout.module_of("host/data/x.c", modules))
        self.assertIsNone(layout.module_of("host/dataset/x.c", modules))

    def test_names_of_the_library(self):
        modules = [("numbers", "lib:iq24*,vector", []), ("cycle", "lib:cycle", ["numbers"])]
        self.assertEqual("numbers", layout.module_of("include/iqfoc/iq24_math.h", modules))
        self.assertEqual("numbers", layout.module_of("src/vector.c", modules))
        self.assertEqual("cycle", layout.module_of("src/cycle.c", modules))
        self.assertIsNone(layout.module_of("src/recorder.c", modules))
        self.assertIsNone(layout.module_of("include/iqfoc/target/iq24.h", modules))

    def test_the_page_is_read(self):
        text = "<!-- modules -->\n\n    base   host/base   <-\n    data   host/data/  <- base\n\n<!-- end -->"
        self.assertEqual([("base", "host/base", []), ("data", "host/data", ["base"])], layout.drawing(text))

    def test_folders(self):
        text = "<!-- folders -->\n| `host/` | `host/base/` | x |\n<!-- end -->"
        with tempfile.TemporaryDirectory() as root:
            os.makedirs(os.path.join(root, "host/base"))
            self.assertEqual([], layout.wrong_folders(text, root, ["host/README.md", "host/base/a.c", "README.md", ".ci/run"]))
            self.assertEqual(["attic/ has no row in the table of folders"], layout.wrong_folders(text, root, ["attic/index.md", "host/README.md"]))
            os.rmdir(os.path.join(root, "host/base"))
            self.assertEqual(["host/base/ is in the table of folders, but not in the tree"], layout.wrong_folders(text, root, ["host/README.md"]))
            os.makedirs(os.path.join(root, "host/base"))
            self.assertEqual(["host/ has no README.md"], layout.wrong_folders(text, root, ["host/base/README.md"]))


if __name__ == "__main__":
    unittest.main()
