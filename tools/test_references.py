#!/usr/bin/env python3
"""check_references.py: what it finds and what it leaves alone; and the documents as they are."""

import io
import pathlib
import subprocess
import tempfile
import unittest

import check_references

FILES = {"README.md": "", "docs/units.md": "", "src/cycle.c": "int iqfoc_cycle_peak(void); /* IQ24_ONE */", "include/iqfoc/hal.h": "",
         "recordings/a.toml": "", "recordings/README.md": ""}


class References(unittest.TestCase):
    def found(self, text, folder="docs"):
        """The references of a text that lead nowhere, in a small tree."""
        with tempfile.TemporaryDirectory() as name:
            root = pathlib.Path(name)
            for file, content in FILES.items():
                (root / file).parent.mkdir(parents=True, exist_ok=True)
                (root / file).write_text(content)
            for arguments in (["init", "-q"], ["add", "-A"]):
                subprocess.run(["git", *arguments], cwd=root, check=True)
            return [reference for _, reference in check_references.missing(text, folder, check_references.Tree(root))]

    def test_links(self):
        self.assertEqual([], self.found("[a](units.md), [b](../src/cycle.c), [c](../recordings), [d](https://x.y/z), [e](units.md#bases)"))
        self.assertEqual(["unit.md", "../src/gone.c"], self.found("[a](unit.md) and [b](../src/gone.c)"))
        self.assertEqual(["units.md"], self.found("[a](units.md)", ""))

    def test_paths(self):
        self.assertEqual([], self.found("`src/cycle.c`, `cycle.c`, `hal.h`, `iqfoc/hal.h`, `src/cyc*`, `recordings/`, `docs/`"))
        self.assertEqual(["src/gone.c", "gone.h", "iqfoc/gone.h", "src/gone*"],
                         self.found("`src/gone.c`, `gone.h`, `iqfoc/gone.h`, `src/gone*`"))
        self.assertEqual(["rc/cycle.c", "docs/hal.h"], self.found("`rc/cycle.c` and `docs/hal.h`"))
        self.assertEqual([], self.found("`DIR/summary.json`, `build/host/iqfoc`, `report.html`, `iqfoc_extension.h`, `a/b`"))

    def test_names(self):
        self.assertEqual([], self.found("`iqfoc_cycle_peak` and IQ24_ONE, IQFOC_JOBS, IQFOC_DIAGNOSED_V_DEAD_V"))
        self.assertEqual(["iqfoc_cycle_valley"], self.found("`iqfoc_cycle_valley(&c)`"))
        self.assertEqual(["iqfoc_gone"], self.found("```c\niqfoc_gone();\n```"))

    def test_code_may_name_other_files(self):
        self.assertEqual([], self.found("```\nsee [a](gone.md) and `src/gone.c`\n```\n    `src/gone.c`\n"))

    def test_the_documents(self):
        out = io.StringIO()
        self.assertEqual(0, check_references.main(out=out), out.getvalue())


if __name__ == "__main__":
    unittest.main()
