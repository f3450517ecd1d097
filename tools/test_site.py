#!/usr/bin/env python3
"""tools/site: comments of a header as its page has them, and the checks of built pages."""

import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "site"))

import api  # noqa: E402
import build  # noqa: E402

HEADER = """/* What it
 * is for. */
#define FIRST  1 /* the first, over
                  * two lines */
#define SECOND 2 /* the second */
#define THIRD  3
""".split("\n")


class Comments(unittest.TestCase):
    def test_above(self):
        self.assertEqual(["What it", "is for."], api.comment_above(HEADER, 3))
        for line in (1, 5, 6):  # what is behind another definition is not this one's
            self.assertEqual([], api.comment_above(HEADER, line), line)

    def test_behind(self):
        self.assertEqual(["The first, over two lines"], api.comment_behind(HEADER, 3))
        self.assertEqual(["The second"], api.comment_behind(HEADER, 5))
        self.assertEqual([], api.comment_behind(HEADER, 6))


class Pages(unittest.TestCase):
    def site(self, **pages):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        for name, text in pages.items():
            file = pathlib.Path(folder.name) / "api" / f"{name}.html"
            file.parent.mkdir(exist_ok=True)
            file.write_text(text)
        return pathlib.Path(folder.name)

    def test_marks_of_comments(self):
        self.assertEqual([], list(build.marks_of_comments(self.site(a="<p>Words <code>/* x */</code></p>"))))
        self.assertEqual(1, len(list(build.marks_of_comments(self.site(a="<p>Words. <em>*/ #define</em> X</p>")))))

    def test_links(self):
        self.assertEqual([], list(build.broken_links(self.site(a='<a href="b.html#x">b</a>', b='<p id="x">'))))
        self.assertEqual(3, len(list(build.broken_links(self.site(
            a='<a href="c.html">c</a> <a href="b.html#y">y</a> <img src="https://x.y/z.png">', b='<p id="x">')))))

    def test_links_of_a_document(self):
        text = "See [the\npage](../src/cycle.c).\n```\n[a](../src/cycle.c)\n```\n    [a](../src/cycle.c)"
        made = build.Stage(pathlib.Path("/")).document(text, "docs/a.md", "a.md")
        self.assertEqual(text.replace("../src/cycle.c", "source/src/cycle.c.md", 1), made)


if __name__ == "__main__":
    unittest.main()
