#!/usr/bin/env python3
"""Whatever ends a command, what it writes is there whole or as it was: signals and failures at its calls to the system, one by one.

    interruptions.py PROGRAM STOP_AT

STOP_AT is the library made of stop_at.c, which is preloaded into the program. Every command that writes is tried (CALLS), over a folder
that holds earlier files of the same names and one of the user's.
"""

import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

import program

STOP_AT = pathlib.Path(sys.argv[2]).resolve()
MAP = "[columns]\n" + "".join(f'{name} = "{name}"\n' for name in (
    "run", "t_s", "i_a_A", "i_b_A", "i_c_A", "theta_e_rad", "omega_e_rad_s", "u_a_V", "u_b_V", "u_c_V"))
MOTOR = ["--motor", "motor.toml"]
# What is called, how many of its calls to the system are picked for each kind of end, and what it may do at the end of its work.
ALL, NONE = 1000, 0  # NONE: it takes seconds, and writes as others do
CONFINED, STARTS = "nothing", "programs"
CALLS = {
    "simulate": (["simulate", *MOTOR, "--scenario", "scenario.toml", "-o", "out/rec.csv"], ALL, CONFINED),
    "export-fmu": (["export-fmu", *MOTOR, "--scenario", "scenario.toml", "-o", "out/drive.fmu"], 3, CONFINED),
    "record": (["record", "--port", "line.uart", "-o", "out/rec.csv"], ALL, CONFINED),
    "import": (["import", "recording.csv", "--map", "map.toml", "-o", "out/rec.csv"], ALL, CONFINED),
    "sweep": (["sweep", *MOTOR, "--rpm", "1000", "-o", "out", "--json", "out/x.json"], ALL, CONFINED),
    "diagnose": (["diagnose", "recording.csv", *MOTOR, "-o", "out", "--json", "out/x.json"], 4, CONFINED),
    "observe": (["observe", "recording.csv", *MOTOR, "-o", "out", "--json", "out/x.json"], ALL, CONFINED),
    "patterns": (["patterns", *MOTOR, "--pulses", "3", "-o", "out", "--json", "out/x.json"], ALL, CONFINED),
    "plot": (["plot", "recording.csv", *MOTOR, "-o", "out/page.html"], ALL, CONFINED),
    "motor": (["motor", "--pole-pairs", "3", "--resistance", "1", "--inductance", "0.01", "--flux", "0.1", "--current", "6", "--u-dc", "500",
               "--f-pwm", "4000", "--name", 100 * "m", "-o", "out/m.toml"], ALL, CONFINED),
    "plan": (["plan", *MOTOR, "--seconds", "1.6", "-o", "out/plan.toml", "--firmware", "out/plan.h", "--json", "out/x.json"], 1,
             CONFINED),
    "tune": (["tune", *MOTOR, "--drives", "1", "-o", "out"], NONE, CONFINED),
    "watch": (["watch", *MOTOR, "--change", "magnet", "-o", "out"], 2, CONFINED),
    "reproduce": (["reproduce", "--paper", "2016", "-o", "out"], 4, STARTS),
    "loops": (["loops", *MOTOR, "--extended", "motor.toml", "--json", "out/x.json"], 2, CONFINED),
}
HOWS = {"kill": -signal.SIGKILL, "int": -signal.SIGINT, "term": -signal.SIGTERM, "error": 1, "full": 1}
HIDDEN = ".iqfoc."


class Interruptions(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        program.write_files(self.folder)
        done = self.run_it(["simulate", *MOTOR, "--scenario", "scenario.toml", "-o", "recording.csv"])
        self.assertEqual(0, done.returncode, done.stderr)
        (self.folder / "map.toml").write_text(MAP)
        (self.folder / "line.uart").write_bytes(program.recorder_line())
        self.out = self.folder / "out"

    def tearDown(self):
        self.temporary.cleanup()

    def run_it(self, arguments, binary=program.PROGRAM, environment=None, **how):
        """The same bytes each time: the page's date is fixed, and gnuplot, which not every machine has, is not there."""
        known = {**os.environ, "SOURCE_DATE_EPOCH": "1700000000", "PATH": "/nonexistent", **(environment or {})}
        return subprocess.run([str(binary), *arguments], cwd=self.folder, env=known, timeout=1200, check=False,
                              **{"stdin": subprocess.DEVNULL, "capture_output": True, **how})

    def content(self):
        return {path.name: path.read_bytes() if path.is_file() else None for path in self.out.iterdir()}

    def put_old(self, names):
        shutil.rmtree(self.out, ignore_errors=True)
        self.out.mkdir()
        for name in [*names, "mine.txt"]:
            (self.out / name).write_text(f"precious {name}")
        return self.content()

    def put_new(self, arguments):
        """The files that a call writes, after an undisturbed run into an empty folder."""
        shutil.rmtree(self.out, ignore_errors=True)
        self.out.mkdir()
        done = self.run_it(arguments)
        self.assertEqual(0, done.returncode, done.stderr)
        return self.content()

    def stopped(self, arguments, at, how):
        return self.run_it(arguments, environment={"LD_PRELOAD": str(STOP_AT), "STOP_AT": str(at), "STOP_HOW": how})

    def calls_of(self, arguments, names):
        """How many calls to the system there are over earlier files."""
        self.put_old(names)
        count = self.folder / "count"
        count.unlink(missing_ok=True)
        done = self.run_it(arguments, environment={"LD_PRELOAD": str(STOP_AT), "STOP_COUNT": str(count)})
        self.assertEqual(0, done.returncode, done.stderr)
        return int(count.read_text())

    def expect_one_line(self, done):
        """Of bad news; `record` says first what came."""
        lines = [line for line in done.stderr.split(b"\n") if line and not line.startswith(b"iqfoc: record: 300 rows in 1 stretches; ")]
        self.assertEqual(1, len(lines), done.stderr)

    def stop_once(self, arguments, new, at, how):
        old = self.put_old(new)
        new = {**new, "mine.txt": old["mine.txt"]}
        before = {path.name for path in self.folder.iterdir()}
        done = self.stopped(arguments, at, how)
        self.assertIn(done.returncode, (0, HOWS[how], 2), done.stderr)
        found = self.content()
        if how == "kill":
            # Between two renames some files are old and some new, which a folder says; the next run leaves nothing of it.
            seen = {name: text for name, text in found.items() if not name.startswith(HIDDEN)}
            self.assertEqual(set(old), set(seen))
            self.assertTrue(seen in (old, new) or (all(seen[name] in (old[name], new[name]) for name in seen) and
                                                   any(name.endswith(".whole") for name in found)), set(found))
            self.assertEqual(0, self.run_it(arguments).returncode)
            self.assertTrue(self.content() == new, set(self.content()))
        else:
            self.assertIn(found, (old, new), done.stderr)
            if done.returncode == 0:
                self.assertTrue(found == new)
            elif done.returncode > 0:
                self.assertTrue(found == old)
                self.expect_one_line(done)
                self.assertNotIn(HIDDEN.encode(), done.stderr)
        self.assertEqual(before, {path.name for path in self.folder.iterdir()})

    def test_the_end_at_any_call_to_the_system(self):
        for command, (arguments, picked, _) in CALLS.items():
            if picked == NONE:
                continue
            new = self.put_new(arguments)
            calls = self.calls_of(arguments, new)
            self.assertGreater(calls, 3)
            for number, how in enumerate(HOWS):
                # Others for each kind of end.
                step = max(1, calls // picked)
                for at in range(1 + number * step // len(HOWS), calls + 1, step):
                    with self.subTest(command=command, how=how, at=at, of=calls):
                        self.stop_once(arguments, new, at, how)


    def expect_failure(self, command, done, status, words, old):
        self.assertEqual(status, done.returncode, done.stderr)
        self.expect_one_line(done)
        self.assertIn(words, done.stderr)
        self.assertTrue(self.content() == old, f"{command}: {set(self.content())}")

    def test_a_file_larger_than_may_be(self):
        """A limit of the user's on the size of files, as a disk that is full from there on."""
        for command, (arguments, picked, _) in CALLS.items():
            if picked == NONE:
                continue
            with self.subTest(command=command):
                old = self.put_old(self.put_new(arguments))
                done = self.run_it(arguments, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (256, 256)))
                self.expect_failure(command, done, 1, b"cannot be written", old)

    def test_files_named_one_by_one(self):
        """The scenario, its header and the results: all of them or none, whichever cannot be written, and wherever they are."""
        (self.folder / "folder").mkdir()
        wanted = {"-o": "out/plan.toml", "--firmware": "out/plan.h", "--json": "out/x.json"}
        for option in wanted:
            for place in ("missing/x", "folder"):
                with self.subTest(option=option, place=place):
                    old = self.put_old(["plan.toml", "plan.h", "x.json"])
                    named = [word for pair in {**wanted, option: place}.items() for word in pair]
                    done = self.run_it(["plan", *MOTOR, "--seconds", "1.6", *named])
                    self.expect_failure("plan", done, 2, place.encode(), old)
        old = self.put_old(["plan.toml"])
        with open("/dev/full", "wb") as full:
            done = self.run_it(["plan", *MOTOR, "--seconds", "1.6", "-o", "out/plan.toml", "--json", "-"], capture_output=False, stdout=full,
                               stderr=subprocess.PIPE)
        self.expect_failure("plan", done, 1, b"No space left", old)
        done = self.run_it(["plan", *MOTOR, "--seconds", "1.6", "-o", "plan.toml", "--json", "x.json", "--firmware", "/dev/null"])
        self.assertEqual(0, done.returncode, done.stderr)
        self.assertTrue((self.folder / "plan.toml").is_file() and (self.folder / "x.json").is_file())
        self.assertFalse([path for path in self.folder.iterdir() if path.name.startswith(HIDDEN)])

    def test_a_folder_that_may_not_be_written(self):
        """As a user who is not root, to whom nothing is forbidden."""
        binary = self.folder / "iqfoc"
        shutil.copy(program.PROGRAM, binary)
        self.folder.chmod(0o755)
        how = {"user": 65534, "group": 65534} if os.geteuid() == 0 else {}
        for command, (arguments, _, _) in CALLS.items():
            with self.subTest(command=command):
                old = self.put_old(["mine.txt"])
                self.out.chmod(0o555)
                done = self.run_it(arguments, binary, **how)
                self.out.chmod(0o755)
                self.expect_failure(command, done, 2, b"Permission denied", old)

    def test_a_full_disk_behind_the_standard_output(self):
        for arguments in (["help"], ["golden"], ["sweep", *MOTOR, "--rpm", "1000"], ["sweep", *MOTOR, "--rpm", "1000", "--json", "-"],
                          ["simulate", *MOTOR, "--scenario", "scenario.toml", "-o", "-"], ["simulate", "--list-effects"],
                          ["import", "recording.csv"], ["import", "recording.csv", "--map", "map.toml", "-o", "-"],
                          ["record", "--port", "line.uart", "-o", "-"], ["--version"], ["help", "--man"],
                          ["help", "--completion", "bash"], ["plan", *MOTOR, "--seconds", "1.6", "-o", "-"]):
            with self.subTest(arguments=arguments), open("/dev/full", "wb") as full:
                done = self.run_it(arguments, capture_output=False, stdout=full, stderr=subprocess.PIPE)
                self.assertEqual(1, done.returncode, done.stderr)
                self.assertIn(b"No space left", done.stderr)

    def test_standard_files_that_are_closed(self):
        """The first file that is opened is not taken for the terminal."""
        for command in ("simulate", "sweep", "record"):
            with self.subTest(command=command):
                arguments = CALLS[command][0]
                new = self.put_new(arguments)
                self.put_old([])
                self.run_it(arguments, capture_output=False, stdin=None, preexec_fn=lambda: os.closerange(0, 3))
                self.assertTrue({**new, "mine.txt": b"precious mine.txt"} == self.content(), set(self.content()))

    def test_two_at_once(self):
        for command, (arguments, picked, _) in CALLS.items():
            if picked == NONE:
                continue
            with self.subTest(command=command):
                new = self.put_new(arguments)
                self.put_old(new)
                environment = {**os.environ, "SOURCE_DATE_EPOCH": "1700000000", "PATH": "/nonexistent"}
                runs = [subprocess.Popen([str(program.PROGRAM), *arguments], cwd=self.folder, env=environment,
                                         stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) for _ in range(2)]
                self.assertEqual([0, 0], [run.wait(120) for run in runs])
                self.assertTrue({**new, "mine.txt": b"precious mine.txt"} == self.content(), set(self.content()))

    def test_what_is_given_up(self):
        """From within, at the end of the work: no socket, no process, no program, but where the command draws by gnuplot."""
        if "Seccomp_filters" not in pathlib.Path("/proc/self/status").read_text():
            self.skipTest("this kernel has no filters of system calls")
        refused = "Operation not permitted"
        for command, (arguments, _, may) in CALLS.items():
            with self.subTest(command=command):
                self.put_old([])
                tried = self.folder / "tried"
                tried.unlink(missing_ok=True)
                done = self.run_it(arguments, environment={"LD_PRELOAD": str(STOP_AT), "STOP_TRY": str(tried)})
                self.assertEqual(0, done.returncode, done.stderr)
                lines = [f"socket: {refused}"]
                lines += [f"process: {refused}", f"program: {refused}"] if may == CONFINED else ["process: done"]
                self.assertEqual(lines, tried.read_text().splitlines())

    def test_there_is_no_shell(self):
        """The program does not even hold the calls by which a command line would get to one."""
        needed = subprocess.run(["nm", "-D", "--undefined-only", program.PROGRAM], capture_output=True, text=True, check=True).stdout
        names = {line.split()[-1].split("@")[0] for line in needed.splitlines()}
        self.assertIn("posix_spawnp", names)
        self.assertFalse(names & {"system", "popen", "wordexp", "execl", "execlp", "execle"})


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:], "-v"])
