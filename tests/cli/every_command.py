"""One small call of every command that `iqfoc help` lists: it succeeds, and a sanitizer that is built in finds nothing."""

import pathlib
import tempfile
import unittest

import program


class EveryCommand(unittest.TestCase):
    def test_every_command(self):
        with tempfile.TemporaryDirectory() as place:
            folder = pathlib.Path(place)
            program.write_small_inputs(folder)
            listed = program.commands_there()
            self.assertEqual(set(listed) - set(program.SMALL), set(), "no small call of these")
            for command in listed:
                with self.subTest(command=command):
                    done = program.run(program.SMALL[command], folder)
                    self.assertEqual(0, done.returncode, done.stderr.decode(errors="replace"))
                    self.assertNotIn(b"Sanitizer", done.stderr)
                    self.assertNotIn(b"runtime error", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=[__file__])
