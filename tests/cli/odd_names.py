#!/usr/bin/env python3
"""Names that are commands, markup, quotes or several lines to somebody: nothing is run, nothing gets into a file but as text."""

import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
import unittest

import program

NAMES = (
    "two words", "it's", 'a "quoted" name', "$(touch ran)", "`touch ran`", "; touch ran;", "| touch ran", "<script>touch('ran')<", "a&b<b>c",
    "Größe 測", "one\ntouch ran", "#include <ran>", "* end *", "back\\slash", "%s%n", "-o", "tab\there", "[table]\nran = 1")


class OddNames(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        program.write_files(self.folder)
        self.assertEqual(0, program.run(["simulate", "--motor", "motor.toml", "--scenario", "scenario.toml", "-o", "recording.csv"],
                                        self.folder).returncode)

    def tearDown(self):
        self.temporary.cleanup()

    def run_in(self, folder, *arguments):
        return subprocess.run([program.PROGRAM, *arguments], cwd=folder, capture_output=True, stdin=subprocess.DEVNULL, timeout=120,
                              check=False)

    def test_files_of_such_names(self):
        for name in NAMES:
            with self.subTest(name=name), tempfile.TemporaryDirectory() as place:
                place = pathlib.Path(place)
                for kind in ("csv", "toml"):
                    source = self.folder / ("recording.csv" if kind == "csv" else "motor.toml")
                    (place / f"{name}.{kind}").write_bytes(source.read_bytes())
                done = self.run_in(place, "diagnose", f"./{name}.csv", "--motor", f"./{name}.toml", "-o", f"./{name}")
                self.assertEqual(0, done.returncode, done.stderr)
                self.assertEqual({f"{name}.csv", f"{name}.toml", name}, {path.name for path in place.iterdir()})
                out = place / name
                self.assertEqual(f"./{name}.csv", json.loads((out / "diagnosis.json").read_text())["recording"])
                motor = tomllib.loads((out / "motor_extended.toml").read_text())
                self.assertNotIn("ran", motor)
                page = (out / "report.html").read_text()
                self.assertNotIn("<script>touch", page)
                self.assertNotIn("<b>c", page)
                made = subprocess.run(["cc", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", "-I", program.ROOT / "include", "-x", "c",
                                       out / "iqfoc_extension.h"], capture_output=True, text=True, check=False)
                self.assertEqual("", made.stderr.replace("#pragma once in main file", ""))

    def test_bad_news_stays_on_one_line(self):
        for name in NAMES:
            with self.subTest(name=name):
                done = self.run_in(self.folder, "diagnose", f"./{name}", "--motor", "motor.toml")
                self.assertEqual(2, done.returncode)
                self.assertEqual(1, done.stderr.count(b"\n"), done.stderr)

    def test_a_full_disk_is_a_failure(self):
        done = self.run_in(self.folder, "sweep", "--motor", "motor.toml", "--rpm", "1000", "--json", "/dev/full")
        self.assertEqual(1, done.returncode)
        self.assertIn(b"No space left", done.stderr)

    def test_two_runs_into_one_folder(self):
        """Each ends well or says why not; the files are of one of them, whole."""
        arguments = ["diagnose", "recording.csv", "--motor", "motor.toml", "-o", "out"]
        runs = [subprocess.Popen([program.PROGRAM, *arguments], cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                 stdin=subprocess.DEVNULL) for _ in range(4)]
        said = [run.communicate(timeout=120)[1] for run in runs]
        self.assertIn(0, [run.returncode for run in runs], said)
        self.assertTrue(all(run.returncode in (0, 1, 2) for run in runs), said)
        json.loads((self.folder / "out" / "diagnosis.json").read_text())
        tomllib.loads((self.folder / "out" / "motor_extended.toml").read_text())
        self.assertTrue((self.folder / "out" / "report.html").read_text().rstrip().endswith("</html>"))

    def test_killed_at_any_time_the_folder_is_old_or_new(self):
        arguments = ["diagnose", "recording.csv", "--motor", "motor.toml", "-o", "out"]
        start = time.monotonic()
        self.assertEqual(0, self.run_in(self.folder, *arguments).returncode)
        whole_s = time.monotonic() - start
        def seen():  # what begins with a dot is a stage that nobody is left to remove
            return {path.name for path in (self.folder / "out").iterdir() if not path.name.startswith(".")}
        names = seen()
        for part in range(8):
            run = subprocess.Popen([program.PROGRAM, *arguments], cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                   stdin=subprocess.DEVNULL)
            time.sleep(whole_s * (part + 1) / 8.0)
            run.send_signal(signal.SIGKILL)
            run.wait()
            with self.subTest(part=part):
                self.assertEqual(names, seen())
                json.loads((self.folder / "out" / "diagnosis.json").read_text())
                self.assertTrue((self.folder / "out" / "report.html").read_text().rstrip().endswith("</html>"))
        # What a run that was killed has left beside the folder, the next one does not mind.
        self.assertEqual(0, self.run_in(self.folder, *arguments).returncode)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
