#!/usr/bin/env python3
"""Tests of check_prose.py, and the check of the documents."""

import io
import pathlib
import tempfile
import unittest

import check_prose

LONG = "a" + " word" * 28  # 141 characters
FITS = "b" * check_prose.WIDTH


class Prose(unittest.TestCase):
    def found(self, text):
        return [number for number, _ in check_prose.too_long(text)]

    def test_the_width_itself_is_allowed(self):
        self.assertEqual([], self.found(FITS))
        self.assertEqual([1], self.found(FITS + "b"))

    def test_prose_everywhere(self):
        self.assertEqual([1, 3, 5, 7], self.found(f"{LONG}\n\n- {LONG}\n\n  {LONG}\n\n## {LONG}\n"))

    def test_what_is_as_wide_as_it_is(self):
        exempt = [f"| {LONG} |", f"    {LONG}", f"```\n{LONG}\n```", f"<!-- {LONG} -->",
                  f"<!-- figures: x -->\n{LONG}\n<!-- end -->", f"<!-- bench: begin -->\n{LONG}\n<!-- bench: end -->"]
        for text in exempt:
            with self.subTest(text=text):
                self.assertEqual([], self.found(text))
                self.assertEqual([text.count("\n") + 2], self.found(f"{text}\n{LONG}"))

    def test_a_file_is_named_with_its_line(self):
        with tempfile.TemporaryDirectory() as name:
            root = pathlib.Path(name)
            (root / "docs").mkdir()
            (root / "README.md").write_text("short\n")
            (root / "docs" / "x.md").write_text(f"short\n{LONG}\n")
            out = io.StringIO()
            self.assertEqual(1, check_prose.main(root, out))
            self.assertEqual(f"docs/x.md:2: {len(LONG)} characters, at most 138 are allowed\n", out.getvalue())
            (root / "docs" / "x.md").write_text("short\n")
            self.assertEqual(0, check_prose.main(root, out))

    def test_the_documents(self):
        out = io.StringIO()
        self.assertEqual(0, check_prose.main(out=out), out.getvalue())


if __name__ == "__main__":
    unittest.main()
