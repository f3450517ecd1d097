#!/usr/bin/env python3
"""Names that are commands, markup, quotes or several lines to somebody: nothing is run, nothing gets into a file but as text."""

import html.parser
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
import unittest
import zipfile
from xml.etree import ElementTree

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
        return subprocess.run([program.PROGRAM, *arguments], cwd=folder, capture_output=True, stdin=subprocess.DEVNULL, timeout=1200,
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
        said = [run.communicate(timeout=1200)[1] for run in runs]
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
        # Leftovers of a killed run next to the folder do not disturb the next one.
        self.assertEqual(0, self.run_in(self.folder, *arguments).returncode)


# Much of the above at once, as the name that a motor file or a scenario gives itself (127 bytes), and, without what no path can hold, as
# a path.
WORST = ("$(touch ran)`touch ran`;touch ran|<script>ran</script><b>c</b>&\"q\" it's */ #include <ran> %s%n \\",
         "--> ]]> Größe 測 $\\mathrm{ran}$ @ran \x1b[31m \n[table]\nran = 1\n0,1,2\n\" onload=\"ran\" ' x='ran")
PLAIN = "a plain name"
# Every command that writes words of its input; {} is the place for a path.
WRITERS = (
    ["simulate", "--motor", "{}.toml", "--scenario", "{}.scenario", "-o", "{}.out/rec.csv"],
    ["simulate", "--motor", "{}.toml", "--scenario", "{}.scenario", "--effect", "resistance:R=1.1", "-o", "{}.out/rec.csv"],
    ["export-fmu", "--motor", "{}.toml", "--scenario", "{}.scenario", "-o", "{}.out/drive.fmu"],
    ["import", "./{}.log", "--map", "{}.map", "-o", "{}.out/rec.csv"],
    ["sweep", "--motor", "{}.toml", "--rpm", "1000", "-o", "{}.out", "--json", "{}.out/x.json"],
    ["diagnose", "./{}.csv", "--motor", "{}.toml", "-o", "{}.out", "--json", "{}.out/x.json"],
    ["patterns", "--motor", "{}.toml", "-o", "{}.out", "--json", "{}.out/x.json"],
    ["observe", "./{}.csv", "--motor", "{}.toml", "-o", "{}.out", "--json", "{}.out/x.json"],
    ["tune", "--motor", "{}.toml", "--drives", "1", "-o", "{}.out", "--json", "{}.out/x.json"],
    ["plan", "--motor", "{}.toml", "--seconds", "1.6", "-o", "{}.out/plan.toml", "--json", "{}.out/x.json"],
    ["watch", "--motor", "{}.toml", "--change", "magnet", "-o", "{}.out"],
)
MAP = "[columns]\n" + "".join(f'{name} = "{name}"\n' for name in (
    "run", "t_s", "i_a_A", "i_b_A", "i_c_A", "theta_e_rad", "omega_e_rad_s", "u_a_V", "u_b_V", "u_c_V"))


class Tags(html.parser.HTMLParser):
    """What is no text of a page: its elements with their attributes, and the scripts."""

    def __init__(self, text):
        super().__init__()
        self.seen, self.script = [], None
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.seen.append((tag, attrs))
        self.script = dict(attrs).get("type", "javascript") if tag == "script" else None

    def handle_endtag(self, tag):
        self.seen.append(tag)
        self.script = None

    def handle_comment(self, data):
        self.seen.append("comment")

    def handle_data(self, data):
        if self.script is not None:
            self.seen.append(shape(json.loads(data)) if "json" in self.script else data)


def shape(value):
    """A value without its texts and numbers."""
    if isinstance(value, dict):
        return {key: shape(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [shape(inner) for inner in value]
    return type(value).__name__


def elements(root):
    return [(element.tag, sorted(element.attrib)) for element in root.iter()]


def bones(path):
    """What a reader of its kind makes of a file, without what is text to it."""
    if path.suffix == ".html":
        return Tags(path.read_text()).seen
    if path.suffix == ".json":
        return shape(json.loads(path.read_text()))
    if path.suffix == ".toml":
        return shape(tomllib.loads(path.read_text()))
    if path.suffix == ".svg":
        return elements(ElementTree.parse(path).getroot())
    if path.suffix == ".fmu":
        with zipfile.ZipFile(path) as archive:
            return {name: elements(ElementTree.fromstring(archive.read(name))) if name.endswith((".xml", ".ssd")) else ""
                    for name in archive.namelist()}
    if path.suffix == ".h":
        # What is left without comments.
        return subprocess.run(["cc", "-fpreprocessed", "-dD", "-E", "-P", "-x", "c", path], capture_output=True, text=True, check=True).stdout
    return [line.split(",") for line in path.read_text().splitlines() if not line.startswith("#")]


class WordsOfStrangers(unittest.TestCase):
    """What a stranger's file says of itself, and what it is called, gets into ours as text and as nothing else."""

    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        program.write_files(self.folder)
        self.assertEqual(0, program.run(["simulate", "--motor", "motor.toml", "--scenario", "scenario.toml", "-o", "recording.csv"],
                                        self.folder).returncode)
        self.recording = (self.folder / "recording.csv").read_text()

    def tearDown(self):
        self.temporary.cleanup()

    def written(self, place, path, words, call, environment=None):
        """The bones of what a call writes when all names are such."""
        place.mkdir()
        for kind, text in (("toml", program.MOTOR), ("scenario", program.SCENARIO)):
            (place / f"{path}.{kind}").write_text("name = " + json.dumps(words, ensure_ascii=False) + text[text.index("\n"):])
        (place / f"{path}.csv").write_text("# " + words.replace("\n", "\n# ") + "\n" + self.recording)
        (place / f"{path}.map").write_text(MAP)
        (place / f"{path}.log").write_text(self.recording)
        out = place / f"{path}.out"
        out.mkdir()
        done = subprocess.run([program.PROGRAM, *(word.replace("{}", path) for word in call)], cwd=place,
                              capture_output=True, stdin=subprocess.DEVNULL, timeout=1200, check=False, env=environment)
        self.assertEqual(0, done.returncode, done.stderr)
        self.assertFalse([file for file in place.rglob("ran")])
        self.assertNotIn(b"\x1b[31m", done.stderr)
        return {file.name: bones(file) for file in out.iterdir()}

    def test_the_same_files_but_for_the_text(self):
        for number, call in enumerate(WRITERS):
            with self.subTest(call=call):
                plain = self.written(self.folder / f"plain{number}", "plain", PLAIN, call)
                self.assertTrue(plain)
                for kind, words in enumerate(WORST):
                    worst = self.written(self.folder / f"worst{number}-{kind}", words.replace("/", ""), words, call)
                    self.assertEqual(set(plain), set(worst))
                    for name, seen in plain.items():
                        self.assertEqual(seen, worst[name], name)

    def test_gnuplot_is_given_no_word_of_the_user(self):
        """The one interpreter that is ever started gets the same script whatever the names are, and no argument but that it is to read it."""
        tools = self.folder / "tools"
        tools.mkdir()
        (tools / "gnuplot").write_text(f"#!/bin/sh\necho \"$@\" >> '{tools}/arguments'\n[ \"$1\" = --version ] && exit 0\n"
                                       f"cat >> \"$SCRIPTS\"\necho '<svg viewBox=\"0 0 6 4\"><g id=\"x\"/></svg>'\n")
        (tools / "gnuplot").chmod(0o755)
        for number, words in enumerate((PLAIN, *WORST)):
            environment = {**os.environ, "PATH": f"{tools}:{os.environ['PATH']}", "SCRIPTS": str(tools / f"script{number}")}
            self.written(self.folder / f"drawn{number}", words.replace("/", ""), words, ["reproduce", "--paper", "2016", "-o", "{}.out"],
                         environment)
        self.assertGreater(len((tools / "script0").read_bytes()), 1000)
        self.assertEqual(1, len({(tools / f"script{number}").read_bytes() for number in range(3)}))
        self.assertEqual({"--version", "-"}, set((tools / "arguments").read_text().split()))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
