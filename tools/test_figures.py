#!/usr/bin/env python3
"""Tests of figures.py: it must find every kind of drift, and touch nothing but its blocks."""

import io
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True

import figures  # noqa: E402
from generators import markdown, papers, thresholds  # noqa: E402


class OneRow:
    """Stands in for the program: one row of one paper."""

    def __init__(self, value=0.8):
        self.value = value

    def json(self, *arguments):
        assert arguments == ("reproduce",)
        return {"rows": [{"paper": "2019", "item": "Table 1", "quantity": "prediction", "method": "quasi-discrete",
                          "condition": "8000 rpm", "unit": "%", "paper_value": 0.76, "value": self.value,
                          "value_iq24": None, "note": "a note"}]}


DOCUMENT = 'Before.\n<!-- figures: papers 2019 "Table 1" -->\nold\n<!-- end -->\nAfter.\n'


class Figures(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.readme = self.root / "README.md"

    def run_on(self, text, mode, value=0.8):
        if text is not None:
            self.readme.write_text(text, encoding="utf-8")
        out = io.StringIO()
        return figures.run(mode, self.root, OneRow(value), out), out.getvalue()

    def test_written_document_passes_the_check_and_keeps_the_rest(self):
        self.assertEqual(self.run_on(DOCUMENT, "write")[0], 0)
        text = self.readme.read_text(encoding="utf-8")
        self.assertTrue(text.startswith("Before.\n<!-- figures"))
        self.assertTrue(text.endswith("<!-- end -->\nAfter.\n"))
        self.assertIn("| 0.76 | 0.8 | - | 1.05 | [1] |\n\n- [1] a note\n", text)
        self.assertEqual(self.run_on(None, "check"), (0, ""))

    def test_only_the_blocks_of_one_generator(self):
        self.readme.write_text(DOCUMENT, encoding="utf-8")
        self.assertEqual(figures.run("write", self.root, OneRow(0.8), io.StringIO(), "front"), 1)  # it has no block here
        self.assertEqual(self.readme.read_text(encoding="utf-8"), DOCUMENT)
        self.assertEqual(figures.run("write", self.root, OneRow(0.8), io.StringIO(), "papers"), 0)
        self.assertIn("| 0.76 | 0.8 |", self.readme.read_text(encoding="utf-8"))

    def test_another_value_is_drift(self):
        self.run_on(DOCUMENT, "write")
        status, words = self.run_on(None, "check", value=0.81)
        self.assertEqual(status, 1)
        self.assertIn("README.md", words)
        self.assertIn("+| prediction | quasi-discrete | 8000 rpm | % | 0.76 | 0.81 |", words)

    def test_edited_block_is_drift_and_check_leaves_the_file(self):
        self.assertEqual(self.run_on(DOCUMENT, "check")[0], 1)
        self.assertEqual(self.readme.read_text(encoding="utf-8"), DOCUMENT)

    def test_block_in_a_code_fence_is_left_alone(self):
        fenced = "```\n" + DOCUMENT + "```\n"
        self.run_on(DOCUMENT + fenced, "write")
        self.assertTrue(self.readme.read_text(encoding="utf-8").endswith(fenced))

    def test_mistakes_are_named_with_file_and_line(self):
        for text, words in [("\n<!-- figures: papers 2019 -->\n", "README.md: line 2: no '<!-- end -->'"),
                            ("<!-- figures: nothing -->\n<!-- end -->\n", "line 1: no generator is named 'nothing'"),
                            ("<!-- figures: papers 1999 -->\n<!-- end -->\n", "line 1: generator papers: expected"),
                            ('<!-- figures: papers 2019 "Table 9" -->\n<!-- end -->\n', "no row for 2019 Table 9"),
                            ("<!-- figures: papers 2019 -->\n" + DOCUMENT, "line 1: another block begins")]:
            status, said = self.run_on(text, "check")
            self.assertEqual(status, 1, text)
            self.assertIn(words, said)

    def test_no_block_at_all_fails(self):
        self.assertEqual(self.run_on("Nothing here.\n", "check")[0], 1)

    def test_program_that_is_not_built_is_named(self):
        with self.assertRaisesRegex(figures.FigureError, "dev build"):
            papers.generate(figures.Program(self.root / "iqfoc"), ["2019"])


class Numbers(unittest.TestCase):
    def test_three_or_four_digits_without_needless_exponents(self):
        for value, text in [(None, "-"), (0, "0"), (0.05296, "0.053"), (22.44, "22.4"), (1.05296, "1.053"), (12345.0, "12340"),
                            (9.5e-6, "9.50e-6"), (-1234567.0, "-1.235e6"), (9.9999e-5, "1.000e-4")]:
            self.assertEqual(markdown.number(value), text)


class Thresholds(unittest.TestCase):
    def test_smallest_of_a_cause_and_of_its_drift(self):
        text = ('CAUSE(A, "a", FIRMWARE_HOLDS, "words")\n/* HYPOTHESIS(H_0, A, "x", (P), .least = 0.001) */\n'
                'HYPOTHESIS(H_1, A, "x", (P), .least = 0.02)\nHYPOTHESIS(H_2, A, "x",\n           (P, Q), .least = 0.01, .in_whole = true)\n'
                'HYPOTHESIS(H_3, A, "x", (P), .least = 0.04, .size = SIZE_RATES)\nCAUSE_END\n'
                'UNNAMED(B, "b", "words")\nHYPOTHESIS(H_4, B, "x", (P), .least = 0.3)\nCAUSE_END\n'
                'CAUSE(C, "c", FIRMWARE_LACKS, "words")\nHYPOTHESIS(H_5, C, "x", (P), .needs = NEEDS_A_COUNT)\nCAUSE_END\n')
        self.assertEqual({"a": [0.01, 0.04]}, thresholds.read(text))

    def test_every_cause_has_a_unit(self):
        text = (pathlib.Path(figures.ROOT) / thresholds.CATALOGUE).read_text(encoding="utf-8")
        self.assertEqual(set(thresholds.UNITS), set(thresholds.read(text)))


if __name__ == "__main__":
    unittest.main()
