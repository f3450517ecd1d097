#!/usr/bin/env python3
"""Out of memory is an error and never a number: one allocation of a command fails, each in turn.

    out_of_memory.py PROGRAM FAIL_AT [--all] [COMMAND ...]

FAIL_AT is the library made of fail_at.c, which is preloaded into the program. Without --all as many allocations of each command that
`iqfoc help` lists are picked as PICKED says, evenly. The property: exit status 0 only with the output of an undisturbed run; else 1 or 2
with one line on stderr that says out of memory, and no file.
"""

import collections
import concurrent.futures
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import program

FAIL_AT = pathlib.Path(sys.argv[2]).resolve()
ALL = "--all" in sys.argv
ONLY = [word for word in sys.argv[3:] if not word.startswith("-")]
# Of each command's allocations so many fail where not all do: few of those that compute for seconds.
PICKED = {"export-fmu": 40, "record": 20, "diagnose": 40, "observe": 40, "patterns": 40, "plot": 40, "plan": 12, "watch": 12, "tune": 4,
          "loops": 4}
OTHERWISE = 60
SAID = (b"out of memory", b"Cannot allocate memory")


def content(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


class OutOfMemory(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.input = pathlib.Path(cls.temporary.name) / "input"
        cls.input.mkdir()
        program.write_small_inputs(cls.input)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def run_it(self, arguments, **environment):
        """In a folder of its own: status, stdout, stderr and the files."""
        with tempfile.TemporaryDirectory(dir=self.temporary.name) as place:
            folder = pathlib.Path(place) / "input"
            shutil.copytree(self.input, folder)
            known = {**os.environ, "SOURCE_DATE_EPOCH": "1700000000", "PATH": "/nonexistent", "IQFOC_JOBS": "1",
                     "LD_PRELOAD": str(FAIL_AT), **environment}
            done = subprocess.run([str(program.PROGRAM), *arguments], cwd=folder, env=known, timeout=1200, check=False,
                                  stdin=subprocess.DEVNULL, capture_output=True)
            return done.returncode, done.stdout, done.stderr, content(folder / "out")

    def fault_of(self, command, done, good):
        """What is wrong with a run, or None."""
        status, stdout, stderr, files = done
        if status == 0:
            same = (stdout, stderr, files) == (good[1], good[2], good[3])
            return None if same else "status 0 with other output"
        if status not in (1, 2):
            return f"status {status}"
        lines = [line for line in stderr.splitlines() if line not in good[2].splitlines()]
        if len(lines) != 1 or not any(said in lines[0] for said in SAID):
            return f"said {stderr!r}"
        return f"left {sorted(files)}" if files else None

    def test_each_allocation(self):
        listed = program.commands_there()
        self.assertEqual(set(listed) - set(program.SMALL), set(), "no small call of these")
        for command in ONLY or listed:
            arguments = program.SMALL[command]
            count = pathlib.Path(self.temporary.name) / f"count-{command}"
            good = self.run_it(arguments, FAIL_COUNT=str(count))
            self.assertEqual(0, good[0], good[2])
            allocations = int(count.read_text())
            self.assertGreater(allocations, 0)
            step = 1 if ALL else max(1, allocations // PICKED.get(command, OTHERWISE))
            tried = range(1 + step // 2, allocations + 1, step)
            results = collections.Counter()
            with concurrent.futures.ThreadPoolExecutor(2) as pool:
                runs = pool.map(lambda at: (at, self.run_it(arguments, FAIL_AT=str(at))), tried)
                for at, done in runs:
                    results[done[0]] += 1
                    with self.subTest(command=command, at=at, of=allocations):
                        self.assertIsNone(self.fault_of(command, done, good))
            print(f"{command}: {len(tried)} of {allocations} allocations fail; exit status {dict(results)}", flush=True)
            # The C library writes without its buffer, the only allocation of some commands.
            self.assertGreater(results[1] + results[2] + (allocations == 1), 0)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]])
