#!/usr/bin/env python3
"""
Processor in the loop: the recording of an emulated core is the host's, fast enough, and every way to die ends in one
clear line within five seconds with no process left behind.

Called by tests/target/run.sh. Broken emulators are scripts of the emulator's name, first in PATH.
"""
import argparse
import os
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
MOTOR = ROOT / "data" / "motors" / "jarzebowicz2019.toml"
SCENARIO = ROOT / "data" / "scenarios" / "identification.toml"
EMULATORS = {"cortex-m4": "qemu-system-arm", "rv32": "qemu-system-riscv32"}
CYCLES_PER_S_MIN = 2000
ERROR_WITHIN_S = 5.0

# What a broken emulator does, the words that the error must hold. `cat >&3`-like tricks are not needed: line 0 is the
# serial line, and so is line 1.
BROKEN = {
    "ends at once": ("exit 9", "ended with status 9"),
    "dies of a signal": ("kill -SEGV $$", "signal 11"),
    "says nothing": ("exec sleep 60", "did not answer"),
    "talks nonsense": ("echo 'Hello from the boot loader'; exec sleep 60", "garbled"),
    "answers with another frame": (r"printf '\132\005\002\033\150\242'; exec sleep 60", "garbled"),
    "stops within a frame": (r"printf '\132\003\000'; exec sleep 60", "did not answer"),
}

failures = []


def check(good, what):
    print(("ok    " if good else "FAIL  ") + what)
    if not good:
        failures.append(what)


def cpu_s():
    """Processor time of all children so far, emulators included."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def simulate(program, out, *more, env=None):
    command = [str(program), "simulate", "--motor", str(MOTOR), "--scenario", str(SCENARIO), "-o", str(out), *more]
    start = time.monotonic()
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200, env=env, check=False)
    return done, time.monotonic() - start


def processes_with(mark):
    """Process ids whose command line holds `mark`."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and mark.encode() in (entry / "cmdline").read_bytes():
                found.append(int(entry.name))
        except OSError:
            pass
    return [pid for pid in found if pid != os.getpid()]


def same_recording(program, folder):
    reference = folder / "host.csv"
    done, _ = simulate(program, reference)
    check(done.returncode == 0, f"host simulates {done.stderr}")
    cycles = reference.read_bytes().count(b"\n") - 2
    for target in EMULATORS:
        out = folder / f"{target}.csv"
        before = cpu_s()
        done, seconds = simulate(program, out, "--target", target)
        used = cpu_s() - before
        check(done.returncode == 0 and out.read_bytes() == reference.read_bytes(),
              f"{target}: {cycles} cycles recorded byte for byte as on the host {done.stderr}")
        # Of processor time, so that a busy machine does not fail the test; on an idle one the two are about the same.
        check(cycles / used >= CYCLES_PER_S_MIN, f"{target}: {cycles / used:.0f} cycles a second of processor time "
              f"(at least {CYCLES_PER_S_MIN}), {cycles / seconds:.0f} on the clock")


def broken_emulators(program, folder):
    for name, (script, words) in BROKEN.items():
        for target, emulator in EMULATORS.items():
            fake = folder / emulator
            fake.write_text(f"#!/bin/sh\n{script}\n")
            fake.chmod(0o755)
            out = folder / "broken.csv"
            env = dict(os.environ, PATH=f"{folder}:{os.environ['PATH']}")
            done, seconds = simulate(program, out, "--target", target, env=env)
            fake.unlink()
            lines = done.stderr.strip().split("\n")
            check(done.returncode == 1 and len(lines) == 1 and words in lines[0] and seconds <= ERROR_WITHIN_S
                  and not out.exists(), f"{target} {name}: after {seconds:.1f} s: {done.stderr.strip()}")


def killed(program, folder, image, victim):
    """Kills one of the two in the middle of a run."""
    out = folder / "killed.csv"
    command = [str(program), "simulate", "--motor", str(MOTOR), "--scenario", str(folder / "long.toml"), "-o", str(out),
               "--target", "cortex-m4", "--image", str(image)]
    child = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    emulators = []
    deadline = time.monotonic() + 10
    while not emulators and time.monotonic() < deadline:
        time.sleep(0.1)
        emulators = [pid for pid in processes_with(str(image)) if pid != child.pid]
    time.sleep(0.5)
    start = time.monotonic()
    os.kill(emulators[0] if victim == "emulator" else child.pid, signal.SIGKILL)
    text = child.communicate(timeout=1200)[1].strip()
    seconds = time.monotonic() - start
    time.sleep(0.3)
    left = processes_with(str(image))
    if victim == "emulator":
        check(child.returncode == 1 and "signal 9" in text and seconds <= ERROR_WITHIN_S,
              f"emulator killed in the middle: after {seconds:.1f} s: {text}")
    check(not left and not out.exists(), f"{victim} killed: nothing left behind {left or ''}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.strip().split("\n")[0])
    parser.add_argument("--build", type=pathlib.Path, required=True)
    options = parser.parse_args()
    program = options.build / "host" / "iqfoc"
    with tempfile.TemporaryDirectory(prefix="iqfoc-pil-") as name:
        folder = pathlib.Path(name)
        same_recording(program, folder)
        broken_emulators(program, folder)
        (folder / "long.toml").write_text('name = "long"\n[[run]]\nduration_s = 60\nspeed_rpm = 1000\ni_q_A = 3\n')
        image = folder / "image.elf"
        image.write_bytes((options.build / "cortex-m4" / "iqfoc_pil.elf").read_bytes())
        killed(program, folder, image, "emulator")
        killed(program, folder, image, "simulator")
        done, _ = simulate(program, folder / "x.csv", "--target", "cortex-m7")
        check(done.returncode == 2 and "expected cortex-m4 or rv32" in done.stderr, "unknown target refused")
        done, _ = simulate(program, folder / "x.csv", "--target", "rv32", "--image", "/nowhere.elf")
        check(done.returncode == 2 and "/nowhere.elf" in done.stderr, "missing image refused")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
