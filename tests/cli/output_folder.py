"""What a command writes into the folder of `-o DIR` appears whole or not at all: interfaces.md, "The command line".

Tried with a gnuplot (which draws contour lines, and nothing else) that is missing, that fails at its second picture, or that never ends;
with a folder that holds a user's file, one
that may not be written, and two programs at once.
"""

import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

import program

SIMULATE = ["simulate", "--motor", "motor.toml", "--scenario", "scenario.toml", "-o", "recording.csv"]
SWEEP = ["sweep", "--motor", "motor.toml", "--rpm", "1000,3000"]
DRAWS = ["reproduce", "--paper", "2016"]
# What each call writes at least, page first; the last draws two pictures by gnuplot.
CALLS = {
    "sweep": (SWEEP, ["index.html"]),
    "diagnose": (["diagnose", "recording.csv", "--motor", "motor.toml"],
                 ["report.html", "motor_extended.toml", "iqfoc_extension.h", "diagnosis.json"]),
    "reproduce": (DRAWS, ["index.html", "2016-figure-8.svg", "2016-figure-9.svg"]),
}
# The lines of a page that differ between two runs: the second, and how the folder was named.
DATE = re.compile(rb"<dt>(date|command)</dt>\n<dd>[^<]*</dd>")
STAGE = re.compile(rb"\.(iqfoc|out)\.\d")

# Answers like gnuplot, and counts its calls and its pictures in files next to it.
GNUPLOT = """#!/bin/sh
echo x >> "$0.called"
[ "$1" = --version ] && exit 0
echo x >> "$0.count"
{act}
echo '<svg viewBox="0 0 6 4"><g id="x"/></svg>'
"""
FAILS_AT = '[ "$(wc -l < "$0.count")" -ge {0} ] && exit 1'


class OutputFolder(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        program.write_files(self.folder)
        self.assertEqual(0, program.run(SIMULATE, self.folder).returncode)
        self.out = self.folder / "out"

    def tearDown(self):
        self.temporary.cleanup()

    def environment(self, gnuplot):
        """A PATH on which the only gnuplot is the given script, or none."""
        tools = self.folder / "tools"
        shutil.rmtree(tools, ignore_errors=True)
        tools.mkdir()
        for name in ("cat", "echo", "sh", "sleep", "wc"):
            (tools / name).symlink_to(shutil.which(name))
        if gnuplot is not None:
            (tools / "gnuplot").write_text(GNUPLOT.format(act=gnuplot))
            (tools / "gnuplot").chmod(0o755)
        return {**os.environ, "PATH": str(tools)}

    def call(self, arguments, environment=None, **how):
        return subprocess.run([str(program.PROGRAM), *arguments], cwd=self.folder, env=environment, capture_output=True, timeout=1200,
                              check=False, **how)

    def content(self, folder=None):
        return {path.name: DATE.sub(b"", path.read_bytes()) for path in (folder or self.out).iterdir()}

    def names(self):
        return {path.name for path in self.folder.iterdir()}

    def expect_whole(self, result, files):
        self.assertEqual(0, result.returncode, result.stderr)
        content = self.content()
        self.assertLessEqual(set(files), set(content))
        self.assertFalse([name for name in content if name.startswith(".")])
        for name, text in [("stdout", result.stdout), ("stderr", result.stderr), *content.items()]:
            self.assertIsNone(STAGE.search(text), f"{name} names the stage")

    def test_a_new_folder_and_a_second_run_over_it(self):
        for command, (arguments, files) in CALLS.items():
            with self.subTest(command=command):
                before = self.names()
                self.expect_whole(self.call([*arguments, "-o", "out"], self.environment("")), files)
                first = self.content()
                (self.out / "mine.txt").write_text("precious")
                page = self.out / files[0]
                page.write_text("old")
                page.chmod(0o640)
                self.expect_whole(self.call([*arguments, "-o", "out/"], self.environment("")), files)
                self.assertTrue({**first, "mine.txt": b"precious"} == self.content(), "another page")
                self.assertEqual(0o640, page.stat().st_mode & 0o777)
                self.assertEqual(before | {"out", "tools"}, self.names())
                self.assertEqual(command == "reproduce", (self.folder / "tools/gnuplot.called").exists())
                shutil.rmtree(self.out)

    def test_parents_are_made(self):
        result = self.call([*SWEEP, "-o", "a/b/out"], self.environment(""))
        self.assertEqual(0, result.returncode, result.stderr)
        self.assertIn("index.html", self.content(self.folder / "a/b/out"))

    def test_json_in_the_folder(self):
        for command, (arguments, files) in CALLS.items():
            with self.subTest(command=command):
                result = self.call([*arguments, "-o", "out", "--json", "out/x.json"], self.environment(""))
                self.expect_whole(result, [*files, "x.json"])
                shutil.rmtree(self.out)

    def test_json_in_the_same_folder_by_another_name(self):
        result = self.call([*SWEEP, "-o", "out", "--json", "./out/x.json"], self.environment(""))
        self.assertEqual(0, result.returncode, result.stderr)
        self.assertIn("x.json", self.content(self.out))

    def test_without_gnuplot_the_page_says_so(self):
        for command, (arguments, files) in CALLS.items():
            with self.subTest(command=command):
                text_files = [name for name in files if not name.endswith(".svg")]
                self.expect_whole(self.call([*arguments, "-o", "out"], self.environment(None)), text_files)
                self.assertFalse([name for name in self.content() if name.endswith(".svg")])
                said = self.content()[files[0]].count(b"gnuplot is not installed")
                self.assertEqual(command == "reproduce", said > 0)
                shutil.rmtree(self.out)

    def expect_untouched(self, arguments, environment, status, words, **how):
        """Once without the folder, once over one that holds an earlier page and a user's file."""
        for precious in (False, True):
            if precious:
                self.out.mkdir()
                for name in ("report.html", "index.html", "mine.txt"):
                    (self.out / name).write_text("precious")
            before = self.names()
            content = self.content() if precious else None
            result = self.call(arguments, environment, **how)
            self.assertEqual(status, result.returncode, result.stderr)
            self.assertEqual(1, result.stderr.count(b"\n"), result.stderr)
            self.assertIn(words, result.stderr)
            self.assertIsNone(STAGE.search(result.stderr), result.stderr)
            self.assertEqual(before, self.names())
            if precious:
                self.assertTrue(content == self.content(), "something was written")
        shutil.rmtree(self.out)

    def test_a_gnuplot_that_fails(self):
        for picture in (1, 2):
            environment = self.environment(FAILS_AT.format(picture))
            self.expect_untouched([*DRAWS, "-o", "out"], environment, 1, b"gnuplot could not draw")

    def test_json_that_cannot_be_written(self):
        for command, (arguments, _) in CALLS.items():
            with self.subTest(command=command):
                self.expect_untouched([*arguments, "-o", "out", "--json", "none/x.json"], self.environment(""), 2, b"none/x.json")

    def test_a_recording_that_cannot_be_used(self):
        (self.folder / "recording.csv").write_text(program.RECORDING)
        self.expect_untouched([*CALLS["diagnose"][0], "-o", "out"], self.environment(""), 2, b"recording.csv")

    def test_a_name_that_is_taken(self):
        (self.out / "index.html").mkdir(parents=True)
        result = self.call([*SWEEP, "-o", "out"], self.environment(""))
        self.assertEqual(2, result.returncode, result.stderr)
        self.assertIn(b"out/index.html: is a directory", result.stderr)
        self.assertEqual(["index.html"], [path.name for path in self.out.iterdir()])

    def test_a_file_in_the_folders_place(self):
        self.out.write_text("precious")
        result = self.call([*SWEEP, "-o", "out"])
        self.assertEqual((2, b"iqfoc: out: is not a directory\n"), (result.returncode, result.stderr))
        self.assertEqual("precious", self.out.read_text())

    def test_a_folder_that_may_not_be_written(self):
        """As a user who is not root, to whom nothing is forbidden; the folder is refused before anything is computed."""
        own = self.folder / "iqfoc"
        shutil.copy(program.PROGRAM, own)
        self.folder.chmod(0o755)
        self.out.mkdir(mode=0o555)
        (self.out / "mine.txt").write_text("precious")
        how = {"user": 65534, "group": 65534} if os.geteuid() == 0 else {}
        if not how:
            self.folder.chmod(0o555)
        try:
            for target in ("out", "new"):
                result = subprocess.run([str(own), *SWEEP, "-o", target], cwd=self.folder, capture_output=True, timeout=1200,
                                        check=False, **how)
                self.assertEqual((2, f"iqfoc: {target}: cannot be written: Permission denied\n"),
                                 (result.returncode, result.stderr.decode()))
        finally:
            self.folder.chmod(0o755)
            self.out.chmod(0o755)
        self.assertEqual({"mine.txt": b"precious"}, self.content())
        self.assertFalse((self.folder / "new").exists())

    def test_a_signal_while_a_picture_is_drawn(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            for target in ("new/out", "out"):
                with self.subTest(signal=number, target=target):
                    environment = self.environment('[ "$(wc -l < "$0.count")" -ge 2 ] && sleep 20')
                    self.out.mkdir(exist_ok=True)
                    (self.out / "index.html").write_text("precious")
                    before = self.names()
                    with subprocess.Popen([str(program.PROGRAM), *DRAWS, "-o", target], cwd=self.folder,
                                          env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                          start_new_session=True) as process:
                        self.wait_for_pictures(2)
                        os.killpg(process.pid, number)
                        process.wait(20)
                    self.assertEqual(-number, process.returncode)
                    self.assertEqual(before, self.names())
                    self.assertEqual({"index.html": b"precious"}, self.content())

    def wait_for_pictures(self, count):
        counter = self.folder / "tools/gnuplot.count"
        end = time.monotonic() + 1200
        while not counter.exists() or counter.read_text().count("x") < count:
            self.assertLess(time.monotonic(), end, "no picture was asked for")
            time.sleep(0.01)

    def test_two_at_once(self):
        """Both draw pictures of their own kind: afterwards the page and the picture are one program's."""
        environments = []
        for name in ("one", "other"):
            environment = self.environment(f"echo '<svg viewBox=\"0 0 6 4\"><g id=\"x\"><text>{name}</text></g></svg>'; exit 0")
            kept = self.folder / name
            (self.folder / "tools").rename(kept)
            environments.append({**environment, "PATH": str(kept)})
        for _ in range(6):
            calls = [subprocess.Popen([str(program.PROGRAM), *DRAWS, "-o", "out"], cwd=self.folder, env=environment,
                                      stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) for environment in environments]
            for process in calls:
                _, error = process.communicate(timeout=1200)
                self.assertEqual((0, b""), (process.returncode, error))
            content = self.content()
            self.assertLessEqual(set(CALLS["reproduce"][1]), set(content))
            picture = re.compile(rb"<text>(one|other)</text>")
            found = [picture.findall(text) for _, text in sorted(content.items(), key=lambda file: file[0] == "index.html")]
            self.assertEqual([*[1] * (len(found) - 1), len(found) - 1], [len(names) for names in found])
            self.assertEqual(1, len({name for names in found for name in names}))
            shutil.rmtree(self.out)


if __name__ == "__main__":
    unittest.main(argv=[__file__, "-v"])
