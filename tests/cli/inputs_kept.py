#!/usr/bin/env python3
"""No command writes onto a file that it reads: exit status 2, one line, and the file as it was, before any work. Tried by the same path,
by another spelling of it, through a symbolic link, as a hard link, and for a file of an output folder."""

import gzip
import hashlib
import os
import pathlib
import resource
import shutil
import sys
import tempfile

import program

ROOT = program.ROOT
NAMES = ("same", "spelled", "symbolic", "hard")
# Processor time of a command that refuses. Reading the inputs takes 0.1 s, with sanitizers 0.5 s; a design takes 10 s and more.
MOST_S = 2.0


def other_name(path, kind):
    """Another name of the file, as a user might have it."""
    if kind == "same":
        return path
    if kind == "spelled":
        return path.parent / ".." / path.parent.name / path.name
    link = path.parent / f"{kind}-{path.name}"
    link.unlink(missing_ok=True)
    if kind == "symbolic":
        link.symlink_to(path)
    else:
        os.link(path, link)
    return link


def processor_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def main():
    failed = []
    tried = 0
    there = program.commands_there()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name) / "work"
        folder.mkdir()
        motor, scenario = folder / "motor.toml", folder / "scenario.toml"
        recording, log = folder / "rec.csv", folder / "log.csv"
        diagnosis, trace = folder / "d.json", folder / "map.toml"
        result = folder / "D"
        shutil.copy(ROOT / "data/recordings/dead_time.toml", motor)
        shutil.copy(ROOT / "data/scenarios/standstill.toml", scenario)
        with gzip.open(ROOT / "data/recordings/dead_time.csv.gz", "rt") as whole:
            recording.write_text("".join(line for line, _ in zip(whole, range(3000))))
        shutil.copy(recording, log)
        names = recording.read_text().split("\n", 1)[0].split(",")
        trace.write_text("[columns]\n" + "".join(f'{n} = {{ from = "{n}" }}\n' for n in names if n != "iq_ref_A"))
        done = program.run(["diagnose", recording, "--motor", motor, "-o", result, "--json", diagnosis], folder)
        if done.returncode != 0:
            sys.exit(f"the diagnosis that is to be overwritten failed: {done.stderr.decode()}")
        extended = result / "motor_extended.toml"
        cases = []
        for kind in NAMES:
            cases += [
                (recording, ["diagnose", recording, "--motor", motor, "--json", other_name(recording, kind)]),
                (motor, ["diagnose", recording, "--motor", motor, "--json", other_name(motor, kind)]),
                (diagnosis, ["tune", "--motor", motor, "--diagnosis", diagnosis, "--drives", "1", "--json", other_name(diagnosis, kind)]),
                (log, ["import", log, "--map", trace, "-o", other_name(log, kind)]),
                (trace, ["import", log, "--map", trace, "-o", other_name(trace, kind)]),
                (motor, ["simulate", "--motor", motor, "--scenario", scenario, "-o", other_name(motor, kind)]),
                (scenario, ["simulate", "--motor", motor, "--scenario", scenario, "-o", other_name(scenario, kind)]),
                (motor, ["export-fmu", "--motor", motor, "-o", other_name(motor, kind)]),
                (log, ["record", "--port", log, "-o", other_name(log, kind)]),
                (recording, ["plot", recording, "--motor", motor, "-o", other_name(recording, kind)]),
                (motor, ["plot", recording, "--motor", motor, "-o", other_name(motor, kind)]),
                (recording, ["observe", recording, "--motor", motor, "--json", other_name(recording, kind)]),
                (motor, ["plan", "--motor", motor, "-o", other_name(motor, kind)]),
                (motor, ["plan", "--motor", motor, "-o", "plan.toml", "--firmware", other_name(motor, kind)]),
                (motor, ["loops", "--motor", motor, "--extended", extended, "--json", other_name(motor, kind)]),
            ]
            cases += [(motor, [*command, "--motor", motor, "--json", other_name(motor, kind)])
                      for command in (["sweep", "--rpm", "1000"], ["sweep", "--map"], ["patterns"], ["watch"], ["tune"], ["plan", "-o", "plan.toml"])]
            cases += [
                (diagnosis, ["watch", "--motor", motor, "--diagnosis", diagnosis, "--json", other_name(diagnosis, kind)]),
                (scenario, ["plan", "--motor", motor, "--against", scenario, "-o", "plan.toml", "--json", other_name(scenario, kind)]),
                (extended, ["loops", "--motor", motor, "--extended", extended, "--json", other_name(extended, kind)]),
            ]
        cases.append((extended, ["diagnose", recording, "--motor", extended, "-o", result]))
        for kept, arguments in cases:
            if arguments[0] not in there:
                continue
            before, start = digest(kept), processor_s()
            done = program.run(arguments, folder)
            taken = processor_s() - start
            tried += 1
            lines = [line for line in done.stderr.decode().split("\n") if line]
            if digest(kept) != before:
                failed.append(f"{arguments}: {kept.name} was overwritten")
                sys.exit("\n".join(failed))
            if done.returncode != 2 or len(lines) != 1 or "is read by this command" not in lines[0]:
                failed.append(f"{arguments}: status {done.returncode}, {lines}")
            if taken > MOST_S:
                failed.append(f"{arguments}: refused after {taken:.1f} s of processor time")
        left = [path.name for path in folder.iterdir() if path.name.startswith(".")]
        if left:
            failed.append(f"left behind: {left}")
    print("\n".join(failed) or f"{tried} outputs that are inputs refused, no input changed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
