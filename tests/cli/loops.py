"""`iqfoc loops` with its own drives: it succeeds, and its orders are those of the papers."""

import json
import pathlib
import tempfile
import unittest

import program


class Loops(unittest.TestCase):
    @unittest.skipUnless("loops" in program.commands_there(), "this build has no loops")
    def test_own_drives(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            done = program.run(["loops", "--json", "out.json"], folder)
            self.assertEqual(0, done.returncode, done.stderr.decode(errors="replace"))
            result = json.loads((folder / "out.json").read_text())
            self.assertEqual(["discrete angle", "corrected, 2016 (10)"], [loop["feedback"] for loop in result["six_step"]])
            exact = [point["rms_percent"] for point in result["current"]
                     if point["loop"] == "deadbeat_exact" and point["belief"] == "right"]
            self.assertEqual(sorted(exact, reverse=True), exact)
            self.assertFalse((folder / "report-loops").exists())


if __name__ == "__main__":
    unittest.main(argv=[__file__, "-v"])
