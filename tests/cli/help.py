#!/usr/bin/env python3
"""Help, version, man pages, completions and suggestions: all from the commands' tables, so that none knows less than another."""

import os
import pathlib
import pty
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import program


def out(*arguments, **more):
    done = subprocess.run([program.PROGRAM, *arguments], capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False, **more)
    assert done.returncode == 0, done.stderr
    return done.stdout


def refused(*arguments):
    done = subprocess.run([program.PROGRAM, *arguments], capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False)
    assert done.returncode == 2 and done.stdout == "", (done.returncode, done.stdout)
    return done.stderr


def hold_back(child):
    """Gives a program a tenth of the clock's time, so that a line which is shown after half a second is shown on a fast machine, too."""
    while child.poll() is None:
        for number, seconds in ((signal.SIGSTOP, 0.045), (signal.SIGCONT, 0.005)):
            child.send_signal(number)
            time.sleep(seconds)


def on_terminal(arguments, held_back=False, **variables):
    """What the program writes to a terminal, stderr included."""
    main, other = pty.openpty()
    environment = {key: value for key, value in os.environ.items() if key != "NO_COLOR"} | {"TERM": "xterm"} | variables
    child = subprocess.Popen([program.PROGRAM, *arguments], stdout=other, stderr=other, stdin=subprocess.DEVNULL, env=environment)
    os.close(other)
    if held_back:
        threading.Thread(target=hold_back, args=(child,), daemon=True).start()
    text = b""
    while True:
        try:
            block = os.read(main, 4096)
        except OSError:  # the other end is closed
            break
        if not block:
            break
        text += block
    child.wait()
    os.close(main)
    return text.decode()


def commands():
    return re.findall(r"^  ([a-z-]+) ", out("help"), re.MULTILINE)


def options_of(command):
    """What --help shows: the long names."""
    return re.findall(r"^  (?:-.,|   ) --([a-z-]+)", out(command, "--help"), re.MULTILINE)


class Help(unittest.TestCase):
    def test_the_overview_and_each_command(self):
        self.assertEqual(out("help"), out("--help"))
        self.assertIn("golden", commands())
        for command in commands():
            with self.subTest(command=command):
                self.assertEqual(out("help", command), out(command, "--help"))
                self.assertEqual("help", options_of(command)[-1])

    def test_version_with_commit(self):
        self.assertRegex(out("-V"), r"^iqfoc \d+\.\d+\.\d+( \(commit [0-9a-f]{10}\+?\))?\n$")
        self.assertEqual(out("-V"), out("--version"))
        self.assertEqual(out("version"), out("--version"))

    def test_man_pages_have_every_option(self):
        for command in commands():
            page = out("help", "--man", command).replace("\\-", "-")
            self.assertTrue(page.startswith(f".TH IQFOC-{command.upper()} 1 "), page[:60])
            self.assertEqual(options_of(command), re.findall(r"^(?:\\fB-.\\fR, )?\\fB--([a-z-]+)", page, re.MULTILINE))
        page = out("help", "--man").replace("\\-", "-")
        self.assertEqual(commands(), re.findall(r"^\\fBiqfoc-([a-z-]+)\\fR\(1\)$", page, re.MULTILINE))

    @unittest.skipUnless(shutil.which("groff"), "no groff here")
    def test_man_pages_are_set_without_complaint(self):
        for command in ("", *commands()):
            page = out("help", "--man", *([command] if command else []))
            done = subprocess.run(["groff", "-man", "-Tascii", "-ww", "-z"], input=page, capture_output=True, text=True, check=False)
            self.assertEqual(("", 0), (done.stderr, done.returncode))

    def complete(self, *words):
        """What bash offers for the last word."""
        with tempfile.TemporaryDirectory() as folder:
            script = pathlib.Path(folder) / "iqfoc"
            script.write_text(out("help", "--completion", "bash"))
            done = subprocess.run(["bash", "-c", '. "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _iqfoc; '
                                   'printf "%s\\n" "${COMPREPLY[@]}"', "bash", script, "iqfoc", *words],
                                  capture_output=True, text=True, check=True)
            return done.stdout.split()

    def test_bash_completes(self):
        self.assertEqual(sorted([*commands(), "--help", "--version"]), sorted(self.complete("")))
        self.assertEqual(["diagnose"], self.complete("dia"))
        for command in commands():
            self.assertEqual(sorted("--" + name for name in options_of(command)), sorted(self.complete(command, "--")))
        self.assertEqual(["dead_time"], self.complete("diagnose", "--skip", "dead"))
        self.assertEqual(["pi", "deadbeat"], self.complete("tune", "--method", ""))
        self.assertEqual(["2016", "2019"], self.complete("reproduce", "--paper", "20"))
        self.assertEqual(["watch"], self.complete("help", "wat"))
        self.assertEqual([], self.complete("diagnose", "--motor", "x"))  # files: bash's own

    def test_zsh_and_fish_have_every_option(self):
        for shell, form in (("zsh", "'--{}"), ("fish", " -l {} ")):
            script = out("help", "--completion", shell)
            for command in commands():
                part = (script.split(f"    {command})\n")[1].split(";;")[0] if shell == "zsh" else
                        "\n".join(line for line in script.splitlines() if f"seen_subcommand_from {command}'" in line))
                for name in options_of(command):
                    self.assertIn(form.format(name), part, f"{shell} {command}")

    @unittest.skipUnless(shutil.which("fish"), "no fish here")
    def test_fish_completes(self):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "iqfoc.fish").write_text(out("help", "--completion", "fish"))
            for line, offered in (("dia", ["diagnose"]), ("diagnose --skip dead", ["dead_time"]),
                                  ("tune --method ", ["deadbeat", "pi"]), ("help wat", ["watch"])):
                done = subprocess.run(["fish", "--no-config", "-c", f"source iqfoc.fish; complete -C 'iqfoc {line}'"], cwd=folder,
                                      env={**os.environ, "HOME": folder}, capture_output=True, text=True, check=True)
                self.assertEqual((done.stderr, sorted(one.split("\t")[0] for one in done.stdout.splitlines())), ("", offered))

    @unittest.skipUnless(shutil.which("zsh"), "no zsh here")
    def test_zsh_completes(self):
        # Its own _arguments wants a terminal: here it prints what it is given.
        asked = ("fpath=($PWD $fpath); autoload -U compinit; compinit -D -u; [[ $_comps[iqfoc] == _iqfoc ]] || exit 9;"
                 "_arguments() { print -rl -- $@ }; _describe() { print -rl -- ${(P)@[-1]} }; autoload -U _iqfoc; CURRENT=$#words; _iqfoc")
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "_iqfoc").write_text(out("help", "--completion", "zsh"))
            for words, wanted in [("''", commands())] + [(f"{command} --", [f"--{name}" for name in options_of(command)])
                                                         for command in commands()]:
                done = subprocess.run(["zsh", "-fc", f"words=(iqfoc {words}); {asked}"], cwd=folder, capture_output=True, text=True,
                                      check=True)
                offered = [re.match(r"[\w-]+", line)[0] for line in done.stdout.splitlines() if not line.startswith("*")]
                self.assertEqual((done.stderr, offered), ("", wanted), words)

    def test_each_misspelt_word_gets_the_one_that_was_meant(self):
        for arguments, meant in (
                (["diagnos"], "did you mean diagnose?"),
                (["help", "swep"], "did you mean sweep?"),
                (["diagnose", "--moter", "m"], "did you mean --motor?"),
                (["diagnose", "--skip", "ded_time"], "did you mean dead_time?"),
                (["simulate", "--motor", "data/recordings/clean.toml", "--scenario", "data/scenarios/standstill.toml", "-o", "/dev/null",
                  "--effect", "dead_tme"], "did you mean dead_time?"),
                (["simulate", "--motor", "data/recordings/clean.toml", "--scenario", "data/scenarios/standstill.toml", "-o", "/dev/null",
                  "--effect", "dead_time:td=1"], "expected one of"),
                (["import", "--preset", "odrve"], "did you mean odrive?"),
                (["help", "--completion", "csh"], "expected bash, zsh or fish"),
                (["--motor"], "expected --help or --version"),
                (["help", "tune", "b"], 'unexpected argument "b"')):
            with self.subTest(arguments=arguments):
                self.assertIn(meant, refused(*arguments))

    def test_progress_is_shown_at_a_terminal(self):
        recording = "data/recordings/dead_time.csv.gz"
        told = on_terminal(["diagnose", recording, "--motor", "data/recordings/dead_time.toml"], held_back=True)
        self.assertRegex(told, r"\rdiagnose: round 1, trying \w")
        # The line is gone before the words come.
        self.assertIn("\r\033[K", told.split(recording, maxsplit=1)[0])
        self.assertNotIn("\rdiagnose:", told.split(recording, maxsplit=1)[1])

    def test_what_takes_seconds_says_how_far_it_is(self):
        motor = ["--motor", "data/motors/compressor_salient.toml"]
        for arguments, line in ((["watch", *motor, "--condition", "constant", "--trials", "0", "--cycles", "3e5"],
                                 r"watch: nothing changes: +\d+ % of 300000 cycles"),
                                (["plan", *motor, "--seconds", "20"], r"plan: +\d+ % of \d+ pieces")):
            with self.subTest(arguments=arguments):
                told = on_terminal(arguments)
                shown, results = told.rsplit("\r\033[K", maxsplit=1)
                self.assertRegex(shown, "\r" + line)
                self.assertNotRegex(results, line)
                piped = subprocess.run([program.PROGRAM, *arguments], capture_output=True, text=True, stdin=subprocess.DEVNULL, check=True)
                self.assertEqual("", piped.stderr)
                self.assertEqual(piped.stdout, results.replace("\r\n", "\n"))

    def test_colour_on_a_terminal_alone(self):
        self.assertIn("\033[1m", on_terminal(["help"]))
        self.assertIn("\033[1;31miqfoc:\033[0m", on_terminal(["none"]))
        for plain in ({"NO_COLOR": "1"}, {"TERM": "dumb"}):
            self.assertNotIn("\033", on_terminal(["help"], **plain) + on_terminal(["none"], **plain))
        self.assertIn("\033[1m", on_terminal(["help"], NO_COLOR=""))
        self.assertNotIn("\033", out("help") + refused("none"))

    def test_golden(self):
        lines = out("golden", "--list").splitlines()
        self.assertEqual(out("golden"), lines[-1] + "\n")
        self.assertRegex(lines[-1], "^golden [0-9a-f]{16}$")
        stored = (program.ROOT / "tests/target/golden/golden.txt").read_text().split("closed_loop")[0].splitlines()
        self.assertEqual(stored, lines[:-1])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
