#!/usr/bin/env python3
"""check_words.py: how it splits sentences, what it finds and what it leaves alone; and the tree as it is."""

import io
import pathlib
import subprocess
import tempfile
import unittest

import check_words

LONG = "The cause " + "and the cause " * 13 + "end."


def split(text):
    return [sentence for kind, lines in check_words.blocks(text) if kind in ("paragraph", "item")
            for _, _, sentence in check_words.sentences(lines)]


def findings(text):
    return [(finding.line, finding.what) for finding in check_words.check_document(text)[0]]


class Sentences(unittest.TestCase):
    def test_plain(self):
        self.assertEqual(["One here.", "Two, over two lines.", "Three?", "Four"], split("One here. Two,\nover two lines. Three?\n\nFour"))

    def test_points_that_end_nothing(self):
        for text in ("A gain of 0.5 at 3.36 V.", "See e.g. the mean, i.e. half.", "L. Jarzebowicz, vol. 42, pp. 576-590.", "`a. b` and `c.d` hold.",
                     "It is in [cycle](a.b.c/d.md).", "The terms a, b, ... and z."):
            self.assertEqual([text], split(text))

    def test_points_that_end_one(self):
        self.assertEqual(["A cycle of 2 ms.", "`x` is next."], split("A cycle of 2 ms. `x` is next."))
        self.assertEqual(["It is in [a](b.md).", "Then c."], split("It is in [a](b.md). Then c."))
        self.assertEqual(["(It is so.)", "Then."], split("(It is so.) Then."))

    def test_lists_and_headings(self):
        self.assertEqual(["Three:", "one", "two, over two lines", "three."], split("# Not. This\n\nThree:\n\n- one\n- two,\n  over two lines\n1. three."))

    def test_what_is_left_out(self):
        text = "---\na: b\n---\n```\nCode.\n```\n    indented\n\n| a | b |\n\n<!-- figures: x y -->\n\nA written line.\n\n<!-- end -->\n\n" \
               "<!-- misra: begin -->\nmore\n<!-- misra: end -->\n<!-- a comment\nof two lines -->\nThe rest."
        self.assertEqual(["The rest."], split(text))

    def test_words_are_counted(self):
        def count(text):
            return [words for _, lines in check_words.blocks(text) for _, words, _ in check_words.sentences(lines)]
        self.assertEqual([5], count("A link to [two words](a/b.md)."))
        self.assertEqual([4], count("Run `iqfoc diagnose REC.csv` first, then."))
        self.assertEqual([3], count("**Three** - *plain* words."))


class Documents(unittest.TestCase):
    def test_a_long_sentence(self):
        self.assertIn((3, "42 words, at most 40"), findings(f"# Title\n\n{LONG}\n"))
        self.assertEqual([], findings(f"| a | {LONG} |\n"))

    def test_a_mean_that_is_too_high(self):
        some = "One two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen seventeen eighteen nineteen twenty"
        self.assertEqual([], findings(f"{some}."))
        self.assertEqual([(1, "mean 21.0 words a sentence, at most 20")], findings(f"{some} more."))

    def test_words_that_are_not_used(self):
        planted = ["It is mended.", "A sum of nought.", "L is borne.", "We reckon so.", "It begins anew.", "It is told here.", "Beside this.",
                   "It is worth a name.", "It goes by that.", "It stands there.", "It takes off half.", "Two, of which one.", "They do much alike.",
                   "A late voltage.", "A late angle.", "The learnt drift.", "In the last digits.", "The free run.", "It runs freely.", "The missing voltage.",
                   "A witness."]
        for sentence in planted:
            self.assertEqual(1, len(findings(f"First.\n\n{sentence}")), sentence)
            self.assertEqual(1, len(findings(f"| a | {sentence} |")), sentence)
        self.assertEqual(len(check_words.UNUSED) + 1, len(planted))  # the open-loop simulation has two of these

    def test_words_that_are(self):
        for sentence in ("T stands for the cycle.", "It amends `mend`, and the standstill.", "Besides, `free_run` is a key.", "Of course it does."):
            self.assertEqual([], findings(sentence), sentence)

    def test_how_a_sentence_begins(self):
        self.assertEqual([(1, 'begins with "Of"')], findings("Of two causes one is named."))
        self.assertEqual([(1, 'begins with "Where"')], findings("Where both are seen, one is named."))


class Sources(unittest.TestCase):
    def test_c(self):
        text = '#include "anew.h"\nint anew; /* One\n   begins anew. */\nputs("stands here"); // mended\n'
        self.assertEqual([3, 4, 4], [finding.line for finding in check_words.check_source("c", text)])

    def test_a_phrase_over_two_lines(self):
        self.assertEqual([2], [finding.line for finding in check_words.check_source("c", "int a;\n/* Two, of\n * which one. */")])

    def test_python(self):
        text = 'told = 1  # told\nprint("it is mended")\n"""first\n\nbeside\n"""\n'
        self.assertEqual([1, 2, 5], [finding.line for finding in check_words.check_source("python", text)])

    def test_shell(self):
        self.assertEqual([2], [finding.line for finding in check_words.check_source("shell", "#!/bin/sh\n# beside\n")])


class Tree(unittest.TestCase):
    def checked(self, files):
        with tempfile.TemporaryDirectory() as name:
            root = pathlib.Path(name)
            for file, content in files.items():
                (root / file).parent.mkdir(parents=True, exist_ok=True)
                (root / file).write_text(content)
            subprocess.run(["git", "init", "-q"], cwd=root, check=True)
            out = io.StringIO()
            return check_words.check_tree(root, out), out.getvalue()

    def test_a_planted_sentence_fails(self):
        self.assertEqual(0, self.checked({"docs/a.md": "Plain.", "src/a.c": "/* Plain. */", "dev": "#!/bin/sh\n"})[0])
        for file, content in (("docs/a.md", "It stands here."), ("docs/deep/a.md", LONG), ("src/a.c", "/* anew */"), ("a.py", "# anew"),
                              ("dev", "#!/usr/bin/env bash\n# anew"), ("a.def", 'X("nought")')):
            status, out = self.checked({file: content})
            self.assertEqual(1, status, file)
            self.assertIn(f"{file}:", out)

    def test_what_is_not_swept_yet(self):
        listed = {check_words.UNSWEPT: "# why\nsrc/old\n", "src/old/a.c": "/* anew */"}
        self.assertEqual(0, self.checked(listed)[0])
        status, out = self.checked({**listed, "src/older.c": "/* anew */"})
        self.assertEqual(1, status)
        self.assertNotIn("src/old/a.c", out)
        self.assertEqual(0, self.checked({check_words.UNSWEPT: "src/*", "src/a.c": "/* anew */"})[0])
        self.assertEqual(1, self.checked({check_words.UNSWEPT: "src/*", "src/a.c": "/* anew */", "src/old/a.c": "/* anew */"})[0])
        status, out = self.checked({**listed, "src/old/a.c": "/* again */"})
        self.assertEqual(1, status)
        self.assertIn("src/old has no finding: remove its line", out)

    def test_the_tree(self):
        out = io.StringIO()
        self.assertEqual(0, check_words.check_tree(out=out), out.getvalue())


if __name__ == "__main__":
    unittest.main()
