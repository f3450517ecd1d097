#!/usr/bin/env python3
"""Tests of check_references.py, and the check of the documents."""

import io
import pathlib
import re
import subprocess
import tempfile
import unittest

import check_references

FILES = {"README.md": "", "docs/units.md": "", "src/cycle.c": "int iqfoc_cycle_peak(void); /* IQ24_ONE */", "include/iqfoc/hal.h": "",
         "data/recordings/a.toml": "", "data/recordings/README.md": ""}


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
        self.assertEqual([], self.found("[a](units.md), [b](../src/cycle.c), [c](../data/recordings), [d](https://x.y/z), [e](units.md#bases)"))
        self.assertEqual(["unit.md", "../src/gone.c"], self.found("[a](unit.md) and [b](../src/gone.c)"))
        self.assertEqual(["units.md"], self.found("[a](units.md)", ""))

    def test_paths(self):
        self.assertEqual([], self.found("`src/cycle.c`, `cycle.c`, `hal.h`, `iqfoc/hal.h`, `src/cyc*`, `data/recordings/`, `docs/`"))
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

    def test_every_command_of_dev_is_on_its_page(self):
        said = subprocess.run([check_references.ROOT / "dev", "help"], check=True, capture_output=True, text=True).stdout
        page = (check_references.ROOT / "docs/development.md").read_text(encoding="utf-8")
        commands = set(re.findall(r"^  ([a-z]+) ", said, re.MULTILINE)) - {"help"}
        self.assertGreater(len(commands), 10)
        self.assertEqual(commands, set(re.findall(r"`\./dev ([a-z]+)[^`]*`", "\n".join(re.findall(r"^\|.*", page, re.MULTILINE)))))

    def test_every_page_leads_to_the_terms(self):
        docs = check_references.ROOT / "docs"
        missing = {page.name for page in docs.glob("*.md") if not re.search(r"\]\((?:concepts|glossary)\.md", page.read_text(encoding="utf-8"))}
        self.assertEqual(set(), missing)


if __name__ == "__main__":
    unittest.main()
