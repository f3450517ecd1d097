#!/usr/bin/env python3
"""Tests of tools/check_places.py on a small library, then on the tree itself."""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import check_places

HEADER = """/* iqfoc_in_a_comment(x); */
int32_t iqfoc_named(int32_t x);
int32_t iqfoc_reached(int32_t x);
static inline int32_t iqfoc_forgotten(int32_t x)
{
    return x;
}
"""
SOURCE = """int32_t iqfoc_named(int32_t x)
{
    return iqfoc_reached(x);
}
"""
USER = "int main(void)\n{\n    return iqfoc_named(1); /* not iqfoc_forgotten */\n}\n"


class Places(unittest.TestCase):
    def mistakes(self, exceptions, header=HEADER, bench=USER):
        with tempfile.TemporaryDirectory() as name:
            root = pathlib.Path(name)
            for path, text in {"include/iqfoc/part.h": header, "src/part.c": SOURCE, "tests/target/golden/a.c": USER, "tests/prove/a.c": USER,
                               "bench/a.c": bench, "tools/places.txt": exceptions}.items():
                (root / path).parent.mkdir(parents=True, exist_ok=True)
                (root / path).write_text(text, encoding="utf-8")
            return check_places.mistakes(root)

    def test_a_function_that_is_nowhere(self):
        found = self.mistakes("")
        self.assertEqual(2, len(found))
        self.assertTrue(all("iqfoc_forgotten" in text for text in found))

    def test_a_header_that_is_not_counted(self):
        self.assertIn("part.h: part.h is not in bench", "\n".join(self.mistakes("golden part.h A reason.\nprove part.h A reason.\n", bench="int main(void);\n")))

    def test_exceptions(self):
        self.assertEqual([], self.mistakes("golden iqfoc_forgotten A reason.\nprove part.h A reason.\n"))
        self.assertEqual(["tools/places.txt: golden iqfoc_named: nothing is missing there"],
                         self.mistakes("golden part.h A reason.\nprove part.h A reason.\ngolden iqfoc_named Why?\n"))

    def test_the_tree(self):
        self.assertEqual([], check_places.mistakes(check_places.ROOT))


if __name__ == "__main__":
    unittest.main()
