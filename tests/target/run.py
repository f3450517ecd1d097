#!/usr/bin/env python3
"""
Runs the test images in QEMU: each must end with status 0 in time, and all builds of `same_bits` must print the same, which is what
tests/target/golden/golden.txt holds.

Called by tests/target/run.sh, which builds them.
"""
import argparse
import concurrent.futures
import pathlib
import subprocess
import sys

# 8 ns an instruction: 125 million a second, so that a carrier half period of 100 us holds 12,500.
EMULATORS = {
    "cortex-m4": ["qemu-system-arm", "-M", "mps2-an386", "-semihosting-config", "enable=on,target=native"],
    "cortex-m0plus": ["qemu-system-arm", "-M", "mps2-an386", "-semihosting-config", "enable=on,target=native"],
    "rv32": ["qemu-system-riscv32", "-M", "virt", "-bios", "none"],
}
COMMON = ["-icount", "shift=3", "-display", "none", "-monitor", "none", "-serial", "stdio", "-kernel"]
TIME_LIMIT_S = 1200  # by the clock: a loaded machine is slow
HERE = pathlib.Path(__file__).resolve().parent
# Tests of the program with the images.
SCRIPTS = ("c28x.py", "ccm.py", "pil.py", "planned.py", "recorder.py", "watched.py", "wire.py")
# The digests as they are meant to be. One that is to change: `build/same_bits/gcc-O2 > tests/target/golden/golden.txt`.
GOLDEN = HERE / "golden" / "golden.txt"
HOST_BUILDS = ("gcc-O2", "clang-O0", "clang-O3")


def run(command):
    """(passed, what it printed)."""
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              timeout=TIME_LIMIT_S, check=False)
    except subprocess.TimeoutExpired as late:
        return False, (late.stdout or b"").decode(errors="replace") + f"\nno end after {TIME_LIMIT_S} s\n"
    text = done.stdout.decode(errors="replace").replace("\r", "")
    return done.returncode == 0, text if done.returncode == 0 else text + f"\nexit status {done.returncode}\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.strip().split("\n")[0])
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--quick", action="store_true", help="Cortex-M4 and gcc alone, no script")
    options = parser.parse_args()

    emulators = {"cortex-m4": EMULATORS["cortex-m4"]} if options.quick else EMULATORS
    host_builds = HOST_BUILDS[:1] if options.quick else HOST_BUILDS
    scripts = () if options.quick else SCRIPTS

    commands = {f"{target} {image.stem}": command + COMMON + [str(image)]
                for target, command in emulators.items()
                for image in sorted((options.build / target / "tests" / "target").glob("*.elf"))
                + [options.build / target / "examples" / name for name in ("first_drive.elf", "own_loop.elf", "sensorless_drive.elf",
                                                                       "commissioning.elf", "pattern_drive.elf")]}
    for build in host_builds:
        commands[f"x86-64 {build} same_bits"] = [str(options.build / "same_bits" / build)]
    if len(commands) < (15 if options.quick else 2 * 15 + 1 + 7) + len(host_builds):
        sys.exit(f"only {len(commands)} images were built: {', '.join(commands)}")

    calls = [[sys.executable, str(HERE / script), "--build", str(options.build)] for script in scripts]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        results = dict(zip(commands, pool.map(run, commands.values())))
        of_scripts = list(zip(scripts, pool.map(run, calls)))
    failed = 0
    for name, (passed, text) in results.items():
        print(("ok    " if passed else "FAIL  ") + name)
        if not passed:
            failed += 1
            print("\n".join("      " + line for line in text.split("\n")[-40:]))

    digests = {name: text for name, (_, text) in results.items() if name.endswith("same_bits")}
    # For tools/golden.py.
    for name, text in digests.items():
        (options.build / "same_bits" / f"{name.split()[0]}.txt").write_text(text)
    digests["tests/target/golden/golden.txt"] = GOLDEN.read_text()
    reference = digests["x86-64 gcc-O2 same_bits"]
    print("\n".join("      " + line for line in reference.strip().split("\n")))
    for name, text in digests.items():
        for mine, other in zip(reference.split("\n"), text.split("\n")):
            if mine != other:
                failed += 1
                print(f"FAIL  {name}: '{other}', but gcc -O2 on x86-64: '{mine}'")
        if len(text) != len(reference):
            failed += 1
            print(f"FAIL  {name}: {len(text)} characters instead of {len(reference)}")
    for script, (passed, text) in of_scripts:
        print(("ok    " if passed else "FAIL  ") + script)
        print("\n".join("      " + line for line in text.strip().split("\n")))
        failed += not passed
    total = len(commands) + 1 + len(scripts)
    failed = min(failed, total)
    print(f"{100 * (total - failed) // total}% tests passed, {failed} tests failed out of {total}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
